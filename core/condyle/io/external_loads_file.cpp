// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/external_loads_file.hpp"

#include <pugixml.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include "condyle/io/near_miss.hpp"

namespace condyle::io {
namespace {

const std::vector<std::string> kForceElements{
    "applied_to_body",  "force_expressed_in_body", "point_expressed_in_body",
    "force_identifier", "point_identifier",        "torque_identifier",
    "data_source_name", "isDisabled",              "appliesForce"};

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1));
}

std::string place(const std::string& text, std::size_t offset) {
  const std::string_view before = std::string_view(text).substr(0, std::min(offset, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const auto last = before.rfind('\n');
  const std::size_t column = last == std::string_view::npos ? before.size() + 1 : before.size() - last;
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// Reads one file, naming it in what it throws.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  ExternalLoadsSpec read() {
    load();
    ExternalLoadsSpec spec;
    spec.source = file_.string();
    const pugi::xml_node top = document_.child("OpenSimDocument");
    const pugi::xml_node loads = (top ? top : document_).child("ExternalLoads");
    if (!loads) {
      const std::string found = document_.document_element().name();
      fail("no element <ExternalLoads> (the file is a <" + found +
           ">): is it OpenSim's external loads?");
    }
    for (const pugi::xml_node node : loads.child("objects").children()) {
      if (node.type() != pugi::node_element) continue;
      if (std::string_view(node.name()) != "ExternalForce") {
        fail("<objects> holds <" + std::string(node.name()) + ">: only ExternalForce is known");
      }
      read_force(node, spec.forces);
    }
    if (spec.forces.empty()) fail("no <ExternalForce> in <objects>");
    spec.data_file = data_file(loads);
    return spec;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(file_.string() + ": " + what);
  }

  void load() {
    std::ifstream stream(file_, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file_)) fail("cannot be opened for reading");
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size());
    if (!result) {
      fail(place(text, static_cast<std::size_t>(result.offset)) + ": " + result.description());
    }
  }

  /// Text of an element; true where it is there at all.
  static bool take(pugi::xml_node force, const char* element, std::string& into) {
    const pugi::xml_node node = force.child(element);
    if (node) into = trimmed(node.text().get());
    return static_cast<bool>(node);
  }

  static bool says(pugi::xml_node force, const char* element, std::string_view word) {
    std::string text;
    take(force, element, text);
    return text == word;
  }

  void read_force(pugi::xml_node node, std::vector<ExternalForceSpec>& forces) {
    ExternalForceSpec force;
    force.name = node.attribute("name").value();
    const std::string who = "ExternalForce '" + force.name + "'";
    for (const pugi::xml_node element : node.children()) {
      if (element.type() != pugi::node_element) continue;
      const std::string name = element.name();
      if (std::find(kForceElements.begin(), kForceElements.end(), name) != kForceElements.end()) continue;
      fail(who + ": unknown element <" + name + ">" + did_you_mean(name, kForceElements) +
           " (known: " + listed(kForceElements) + ")");
    }
    if (says(node, "isDisabled", "true") || says(node, "appliesForce", "false")) return;
    take(node, "applied_to_body", force.applied_to_body);
    take(node, "force_expressed_in_body", force.force_expressed_in_body);
    take(node, "point_expressed_in_body", force.point_expressed_in_body);
    take(node, "force_identifier", force.force_identifier);
    take(node, "point_identifier", force.point_identifier);
    take(node, "torque_identifier", force.torque_identifier);
    if (force.applied_to_body.empty()) fail(who + ": no <applied_to_body>");
    if (force.force_identifier.empty() && force.torque_identifier.empty()) {
      fail(who + ": neither <force_identifier> nor <torque_identifier>");
    }
    if (force.force_identifier.empty() && !force.point_identifier.empty()) {
      fail(who + ": a <point_identifier> without a <force_identifier>");
    }
    if (force.force_expressed_in_body.empty()) force.force_expressed_in_body = "ground";
    if (force.point_expressed_in_body.empty()) force.point_expressed_in_body = "ground";
    forces.push_back(std::move(force));
  }

  std::filesystem::path data_file(pugi::xml_node loads) const {
    std::string named;
    if (!take(loads, "datafile", named) || named.empty()) fail("no <datafile>");
    const std::filesystem::path found = file_.parent_path() / named;
    if (!std::filesystem::exists(found)) {
      fail("<datafile> is '" + named + "': there is no " + found.string());
    }
    return found;
  }

  std::filesystem::path file_;
  pugi::xml_document document_;
};

}  // namespace

ExternalLoadsSpec read_external_loads_file(const std::filesystem::path& file) {
  return Reader(file).read();
}

}  // namespace condyle::io
