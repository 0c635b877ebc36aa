// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

#include "condyle/io/load_case_table.hpp"
#include "io/scratch_file.hpp"

using condyle::io::read_load_case;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

const std::string kHeader =
    "# edition and polarity\ntime_s,flexion_deg,axial_force_N,ap_force_N,ie_torque_Nm\n";

std::string refusal(const ScratchFile& file) {
  return message_of<std::invalid_argument>([&] { read_load_case(file.path()); });
}

}  // namespace

TEST_CASE("a load case is read by column name, flexion in radians [property]") {
  const ScratchFile file("case.csv",
                         "ie_torque_Nm,percent,ap_force_N,time_s,axial_force_N,flexion_deg\n"
                         "1.5,0,-20,0.25,167.6,-1.5\n-3,50,40,0.75,2600,58\n");
  const auto load_case = read_load_case(file.path());
  REQUIRE(load_case.size() == 2);
  CHECK(load_case.time == std::vector<double>{0.25, 0.75});
  CHECK(load_case.axial_force == std::vector<double>{167.6, 2600.0});
  CHECK(load_case.ap_force == std::vector<double>{-20.0, 40.0});
  CHECK(load_case.ie_torque == std::vector<double>{1.5, -3.0});
  // sin 58° to the last digit: the angle is in radians and the right one.
  CHECK(std::abs(std::sin(load_case.flexion[1]) - 0.84804809615642596) < 1e-15);
  CHECK(load_case.flexion[0] < 0.0);
}

TEST_CASE("a load case that cannot be is refused with its file and field [error]") {
  const ScratchFile missing("case_missing.csv",
                            "time_s,flexion_deg,axial_force_N,ap_force_N\n0,0,0,0\n");
  CHECK(refusal(missing) == missing.name() +
                                ": no column 'ie_torque_Nm' (columns: time_s, flexion_deg, "
                                "axial_force_N, ap_force_N)");
  const ScratchFile nan("case_nan.csv", kHeader + "0,0,100,0,0\n1,nan,100,0,0\n");
  CHECK(refusal(nan) == nan.name() + ", line 4, column 'flexion_deg': nan is not finite");
  const ScratchFile back("case_time.csv", kHeader + "0,0,100,0,0\n0,5,100,0,0\n");
  CHECK(refusal(back).starts_with("load case '" + back.name() + "': time in row 1"));
  const ScratchFile pull("case_pull.csv", kHeader + "0,0,-100,0,0\n");
  CHECK(refusal(pull).starts_with("load case '" + pull.name() + "': axial_force in row 0 is -100"));
}
