// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "condyle/io/short_number.hpp"
#include "condyle/io/trial_snapshots.hpp"
#include "io/scratch_file.hpp"
#include "support/forearm_model.hpp"

using condyle::io::read_trial_snapshots;
using condyle::model::Model;
using condyle::test::message_of;
using condyle::test::ScratchFile;

namespace {

/// The flexor as the model has it, but for its end along the forearm [m], at times 0.4, 0.42, 0.44.
std::string snapshots(double end) {
  const std::string path = R"({"points": [[0, 0, 0.3, 0], [0, 0.01, 0.2, 0], [1, )" +
                           condyle::io::short_number(end) + ", 0, 0]]}";
  return R"({"format": "condyle-path-snapshots", "version": 1, "source": "a test",
             "bodies": ["ground", "forearm"], "times": [0.4, 0.42, 0.44],
             "paths": {"flexor": [)" +
         path + ", " + path + ", " + path + "]}}";
}

}  // namespace

TEST_CASE("a time frame takes the snapshot of its own time") {
  const Model model(condyle::test::forearm_model());
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.7);
  const ScratchFile file("paths.json", snapshots(0.04));
  const std::vector<double> times{0.42 + 9e-6, 0.44 - 9e-6};
  const auto found = read_trial_snapshots(file.path(), model, times, q);
  CHECK(found.rows == std::vector<std::size_t>{1, 2});
  CHECK(found.snapshots.find("flexor", 1)->points.size() == 3);

  const std::vector<double> between{0.42, 0.43};
  CHECK(message_of<std::invalid_argument>([&] {
          read_trial_snapshots(file.path(), model, between, q);
        }) == file.name() +
                  ": no snapshot at 0.43 s; it has 3 from 0.4 to 0.44 s: snapshots are made of the "
                  "motion that they go with");
  const std::vector<double> beyond{0.4401};
  CHECK(message_of<std::invalid_argument>([&] {
          read_trial_snapshots(file.path(), model, beyond, q);
        }).starts_with(file.name() + ": no snapshot at 0.4401 s"));
}

TEST_CASE("paths of another model begin or end elsewhere [error]") {
  const Model model(condyle::test::forearm_model());
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.7);
  const std::vector<double> times{0.4};
  const ScratchFile near("near.json", snapshots(0.04005)), far("far.json", snapshots(0.0423));
  CHECK(read_trial_snapshots(near.path(), model, times, q).rows.size() == 1);
  CHECK(message_of<std::invalid_argument>([&] {
          read_trial_snapshots(far.path(), model, times, q);
        }) == far.name() +
                  ": muscle 'flexor' ends 2.3 mm from where model 'forearm' has it: snapshots of "
                  "another model");
}
