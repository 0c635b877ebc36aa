// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/path_snapshot_file.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "condyle/io/json_node.hpp"
#include "condyle/io/json_text.hpp"
#include "condyle/io/near_miss.hpp"

namespace condyle::io {
namespace {

using model::HeldPoint;
using model::ModelDescription;
using model::PathSnapshot;
using model::PathSnapshots;

std::vector<std::string> body_names(const ModelDescription& model) {
  std::vector<std::string> names;
  for (const auto& body : model.bodies) names.push_back(body.name);
  return names;
}

std::vector<std::string> path_names(const ModelDescription& model) {
  std::vector<std::string> names;
  for (const auto& muscle : model.muscles) names.push_back(muscle.name);
  for (const auto& ligament : model.ligaments) names.push_back(ligament.name);
  return names;
}

/// Index into the model's bodies of each of the file's; −1: ground.
std::vector<int> read_bodies(const JsonNode& list, const ModelDescription& model) {
  const std::vector<std::string> names = body_names(model);
  std::vector<int> bodies;
  for (const JsonNode& item : list.items()) {
    const std::string name = item.name();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end() && name != model::kGround) {
      item.fail("model '" + model.name + "' has no body '" + name + "'" +
                did_you_mean(name, names));
    }
    bodies.push_back(found == names.end() ? -1 : static_cast<int>(found - names.begin()));
  }
  return bodies;
}

std::vector<double> read_times(const JsonNode& list) {
  std::vector<double> times = list.numbers(1);
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] > times[i - 1]) continue;
    list.items()[i].fail(json_number(times[i]) + " s after " + json_number(times[i - 1]) +
                         " s: times must ascend");
  }
  return times;
}

HeldPoint read_point(const JsonNode& node, const std::vector<int>& bodies) {
  const std::vector<double> numbers = node.numbers();
  if (numbers.size() != 4) {
    node.fail("a list of " + std::to_string(numbers.size()) +
              ": must be of 4: the body's index, x, y, z");
  }
  const double index = numbers[0];
  if (index != std::floor(index) || index < 0 || index >= static_cast<double>(bodies.size())) {
    node.fail("body " + json_number(index) + ": must be an index into the file's " +
              std::to_string(bodies.size()) + " bodies, from 0");
  }
  return {bodies[static_cast<std::size_t>(index)], {numbers[1], numbers[2], numbers[3]}};
}

PathSnapshot read_snapshot(const JsonNode& node, const std::vector<int>& bodies) {
  node.require_keys({"points", "arc_excess"});
  PathSnapshot snapshot;
  const JsonNode points = node.at("points");
  for (const JsonNode& point : points.items()) snapshot.points.push_back(read_point(point, bodies));
  if (snapshot.points.size() < 2) {
    points.fail("a list of " + std::to_string(snapshot.points.size()) +
                ": a path has at least 2 points");
  }
  if (const auto excess = node.find("arc_excess")) snapshot.arc_excess = excess->number();
  return snapshot;
}

PathSnapshots read_snapshots(const JsonNode& root, const ModelDescription& model) {
  root.require_format(kPathSnapshotsFormat, kPathSnapshotsVersion);
  root.require_keys({"format", "version", "source", "bodies", "times", "paths"});
  if (const auto source = root.find("source")) source->text();
  PathSnapshots snapshots;
  const std::vector<int> bodies = read_bodies(root.at("bodies"), model);
  snapshots.times = read_times(root.at("times"));
  const JsonNode paths = root.at("paths");
  const std::vector<std::string> known = path_names(model);
  for (const std::string& name : paths.keys()) {
    const JsonNode path = paths.at(name);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      path.fail("model '" + model.name + "' has no muscle or ligament '" + name + "'" +
                did_you_mean(name, known));
    }
    const auto entries = path.items();
    if (entries.size() != snapshots.times.size()) {
      path.fail(std::to_string(entries.size()) + " snapshots: must be one for each of the " +
                std::to_string(snapshots.times.size()) + " times");
    }
    auto& into = snapshots.paths[name];
    into.reserve(entries.size());
    for (const JsonNode& entry : entries) into.push_back(read_snapshot(entry, bodies));
  }
  return snapshots;
}

std::string snapshot_text(const PathSnapshot& snapshot, int n_bodies) {
  std::vector<std::string> points;
  for (const HeldPoint& point : snapshot.points) {
    if (point.body < -1 || point.body >= n_bodies) {
      throw std::invalid_argument("body " + std::to_string(point.body) + ": the model has " +
                                  std::to_string(n_bodies));
    }
    // The file's list is ground and then the model's bodies.
    const double numbers[] = {point.body + 1.0, point.location[0], point.location[1],
                              point.location[2]};
    points.push_back(json_numbers(numbers));
  }
  JsonObject object;
  object.add("points", json_list(points));
  object.add_number("arc_excess", snapshot.arc_excess);
  return object.text();
}

}  // namespace

PathSnapshots read_path_snapshots(const std::filesystem::path& file,
                                  const ModelDescription& model) {
  PathSnapshots snapshots = read_snapshots(JsonNode::read(file), model);
  snapshots.source = file.string();
  return snapshots;
}

PathSnapshots parse_path_snapshots(std::string_view json, std::string source,
                                   const ModelDescription& model) {
  PathSnapshots snapshots = read_snapshots(JsonNode::parse(json, source), model);
  snapshots.source = std::move(source);
  return snapshots;
}

std::string path_snapshots_text(const PathSnapshots& snapshots, const ModelDescription& model,
                                std::string_view provenance) {
  std::vector<std::string> bodies{json_string(model::kGround)};
  for (const std::string& body : body_names(model)) bodies.push_back(json_string(body));
  JsonObject paths, object;
  for (const auto& [name, entries] : snapshots.paths) {
    std::vector<std::string> texts;
    for (const PathSnapshot& entry : entries) {
      try {
        texts.push_back(snapshot_text(entry, static_cast<int>(model.bodies.size())));
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument("path snapshots: '" + name + "', time frame " +
                                    std::to_string(texts.size()) + ": " + error.what());
      }
    }
    paths.add(name, json_list(texts));
  }
  object.add_string("format", kPathSnapshotsFormat);
  object.add("version", std::to_string(kPathSnapshotsVersion));
  object.add_string("source", provenance);
  object.add("bodies", json_list(bodies));
  object.add("times", json_numbers(snapshots.times));
  object.add("paths", paths.text());
  return object.text() + '\n';
}

}  // namespace condyle::io
