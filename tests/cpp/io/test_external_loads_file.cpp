// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>

#include "condyle/io/external_loads_file.hpp"
#include "io/scratch_file.hpp"

using condyle::io::ExternalLoadsSpec;
using condyle::io::read_external_loads_file;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

const std::string kForce = R"(
    <ExternalForce name="plate">
      <!--a comment-->
      <applied_to_body> calcn_r </applied_to_body>
      <force_expressed_in_body>ground</force_expressed_in_body>
      <point_expressed_in_body>tibia_r</point_expressed_in_body>
      <force_identifier>f_v</force_identifier>
      <point_identifier>f_p</point_identifier>
      <torque_identifier>f_m</torque_identifier>
    </ExternalForce>)";

std::string document(const std::string& objects, const std::string& rest) {
  return R"(<?xml version="1.0" encoding="UTF-8" ?>
<OpenSimDocument Version="40000">
  <ExternalLoads name="loads">
    <objects>)" + objects + "\n    </objects>\n" + rest + R"(
  </ExternalLoads>
</OpenSimDocument>)";
}

std::string refusal(const std::string& text) {
  const ScratchFile file("loads.xml", text);
  const std::string message =
      message_of<std::invalid_argument>([&] { read_external_loads_file(file.path()); });
  return message.starts_with(file.name()) ? message.substr(file.name().size()) : message;
}

const std::string kData = "<datafile>condyle_io_grf.sto</datafile>";

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace

TEST_CASE("forces and their table are read; a switched-off force is left out [property]") {
  const ScratchFile table("grf.sto", "n");
  const std::string off = changed(kForce, "<applied", "<isDisabled>true</isDisabled><applied");
  const std::string idle = changed(kForce, "<applied", "<appliesForce>false</appliesForce><applied");
  const ScratchFile file("loads.xml", document(off + kForce + idle, kData));
  const ExternalLoadsSpec spec = read_external_loads_file(file.path());
  CHECK(spec.source == file.name());
  CHECK(spec.data_file == table.path());
  REQUIRE(spec.forces.size() == 1);
  CHECK(spec.forces[0].name == "plate");
  CHECK(spec.forces[0].applied_to_body == "calcn_r");
  CHECK(spec.forces[0].force_expressed_in_body == "ground");
  CHECK(spec.forces[0].point_expressed_in_body == "tibia_r");
  CHECK(spec.forces[0].force_identifier == "f_v");
  CHECK(spec.forces[0].point_identifier == "f_p");
  CHECK(spec.forces[0].torque_identifier == "f_m");
}

TEST_CASE("what is missing or unknown is named by force and element [error]") {
  const ScratchFile table("grf.sto", "n");
  CHECK(refusal(document(kForce, kData)) == "nothing thrown");
  CHECK(refusal("<a>\n  <b>\n</a>").starts_with(": line 3, column "));
  CHECK(refusal("<Model/>") ==
        ": no element <ExternalLoads> (the file is a <Model>): is it OpenSim's external loads?");
  CHECK(refusal(document("", kData)) == ": no <ExternalForce> in <objects>");
  CHECK(refusal(document("<Prescribed/>", kData)) ==
        ": <objects> holds <Prescribed>: only ExternalForce is known");
  CHECK(refusal(document(kForce, "")) == ": no <datafile>");
  CHECK(refusal(document(kForce, "<datafile>other.sto</datafile>"))
            .starts_with(": <datafile> is 'other.sto': there is no "));
  CHECK(refusal(document(changed(kForce, " calcn_r ", ""), kData)) ==
        ": ExternalForce 'plate': no <applied_to_body>");
  CHECK(refusal(document(changed(changed(kForce, "f_v", ""), "f_m", ""), kData)) ==
        ": ExternalForce 'plate': neither <force_identifier> nor <torque_identifier>");
  CHECK(refusal(document(changed(kForce, "f_v", ""), kData)) ==
        ": ExternalForce 'plate': a <point_identifier> without a <force_identifier>");
  CHECK(refusal(document(changed(kForce, "<!--a comment-->", "<point_identifer>x</point_identifer>"), kData))
            .starts_with(": ExternalForce 'plate': unknown element <point_identifer>, did you mean "
                         "'point_identifier'? (known: applied_to_body, "));
  const ScratchFile absent("absent.xml");
  CHECK(message_of<std::invalid_argument>([&] { read_external_loads_file(absent.path()); }) ==
        absent.name() + ": cannot be opened for reading");
}
