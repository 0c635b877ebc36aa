// SPDX-License-Identifier: Apache-2.0
// condyle-sim contact: loads at the poses of a table.
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "condyle/common/parallel.hpp"
#include "condyle/io/pose_table.hpp"
#include "condyle/io/table.hpp"
#include "condyle/surrogate/onnx_contact_model.hpp"
#include "implant_options.hpp"
#include "load_columns.hpp"
#include "subcommands.hpp"

namespace condyle::apps {
namespace {

struct ContactOptions {
  ImplantOptions implant;
  std::string poses;
  std::string out;
  int threads = 0;
};

/// One number of a side, for every pose.
template <typename Get>
void add_detail(io::Table& table, Side side, const char* what,
                const std::vector<contact::ContactDetail>& details, const Get& get) {
  std::vector<double> values;
  values.reserve(details.size());
  for (const auto& detail : details) values.push_back(get(detail.sides[side]));
  table.add_column(std::string(name(side)) + "_" + what, std::move(values));
}

io::Table mesh_loads(const ContactOptions& options, const std::vector<Pose>& poses) {
  const auto model = read_mesh_contact(options.implant);
  std::vector<contact::ContactDetail> details(poses.size());
  parallel_for(poses.size(), options.threads,
               [&](std::size_t i) { details[i] = model->evaluate_detail(poses[i]); });

  std::vector<contact::ContactLoads> loads(poses.size());
  io::TextColumn status{"status", {}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (const Side side : {kMedial, kLateral}) {
      loads[i].wrench[side] = details[i].sides[side].wrench;
    }
    status.values.push_back(details[i].status);
  }
  io::Table table;
  io::add_poses(table, poses);
  for (const Side side : {kMedial, kLateral}) {
    add_wrench(table, side, loads);
    add_detail(table, side, "volume", details, [](const auto& s) { return s.volume; });
    add_detail(table, side, "area", details, [](const auto& s) { return s.area; });
    add_detail(table, side, "max_depth", details, [](const auto& s) { return s.max_depth; });
  }
  table.text_columns.push_back(std::move(status));
  return table;
}

/// A wrench-only file does not know its trust; the column is then left out.
io::Table surrogate_loads(const ContactOptions& options, const std::vector<Pose>& poses) {
  require_no_meshes(options.implant);
  const surrogate::OnnxContactModel model(options.implant.surrogate,
                                          surrogate::runtime_from_name(options.implant.runtime));
  std::vector<contact::ContactLoads> loads(poses.size());
  model.evaluate_batch(poses, contact::Derivatives::kNone, options.threads, loads);

  io::TextColumn status{"status", {}};
  for (const auto& load : loads) {
    const char* trusted = load.trust >= 0.5 ? "ok" : "untrusted";
    status.values.emplace_back(std::isnan(load.trust) ? "trust unknown" : trusted);
  }
  io::Table table;
  io::add_poses(table, poses);
  for (const Side side : {kMedial, kLateral}) add_wrench(table, side, loads);
  if (model.has_stiffness()) add_trust(table, loads);
  table.text_columns.push_back(std::move(status));
  return table;
}

void run(const ContactOptions& options) {
  const std::vector<Pose> poses = io::read_poses(options.poses);
  const io::Table table = options.implant.surrogate.empty() ? mesh_loads(options, poses)
                                                            : surrogate_loads(options, poses);
  io::write_whole(options.out, io::to_csv(table));
  std::cout << options.out << ": " << poses.size() << " poses\n";
}

}  // namespace

void add_contact(CLI::App& program) {
  auto options = std::make_shared<ContactOptions>();
  CLI::App* command = program.add_subcommand("contact", "Contact loads at the poses of a table");
  add_implant_options(*command, options->implant, "exact");
  command->add_option("--poses", options->poses, "CSV: x,y,z [m],theta_x,theta_y,theta_z [rad]")
      ->required();
  command->add_option("--out", options->out, "CSV to write: poses, loads per side, status")
      ->required();
  command->add_option("--threads", options->threads, "Threads; 0 for all cores")
      ->capture_default_str();
  command->callback([options] { run(*options); });
}

}  // namespace condyle::apps
