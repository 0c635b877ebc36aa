// SPDX-License-Identifier: Apache-2.0
#include "condyle/io/surface_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "condyle/io/json_node.hpp"
#include "condyle/io/near_miss.hpp"

namespace condyle::io {
namespace {

/// Reads one file, naming it in what it throws.
class Reader {
 public:
  Reader(const std::filesystem::path& file, const model::Model& model)
      : file_(file), model_(model) {}

  std::vector<SurfaceFile> read() const {
    std::vector<SurfaceFile> surfaces;
    for (const JsonNode& item : at(JsonNode::read(file_), "contact_surfaces").items()) {
      surfaces.push_back(read_surface(item));
      const std::string& name = surfaces.back().name;
      const auto same = [&](const SurfaceFile& other) { return other.name == name; };
      if (std::count_if(surfaces.begin(), surfaces.end(), same) > 1) {
        fail("surface '" + name + "' is there twice");
      }
    }
    return surfaces;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::invalid_argument(file_.string() + ": " + what);
  }

  JsonNode at(const JsonNode& node, std::string_view key) const {
    auto found = node.find(key);
    if (!found) {
      fail("no '" + std::string(key) +
           "'; contact_surfaces is a list of name, mesh and frame (body, translation, "
           "orientation_xyz), as in a model file");
    }
    return *std::move(found);
  }

  template <typename Items>
  void require_known(const char* what, const std::string& name, const Items& items) const {
    std::vector<std::string> known;
    for (const auto& item : items) known.push_back(item.name);
    if (std::find(known.begin(), known.end(), name) != known.end()) return;
    const std::string near = near_miss(name, known);
    fail("model '" + model_.description().name + "' has no " + what + " '" + name + "'; " +
         (near.empty() ? "it has " + std::to_string(known.size()) + " of them"
                       : "did you mean '" + near + "'?"));
  }

  SurfaceFile read_surface(const JsonNode& node) const {
    SurfaceFile surface;
    surface.name = at(node, "name").name();
    const JsonNode frame = at(node, "frame");
    require_known("contact surface", surface.name, model_.description().contact_surfaces);
    model::FrameDescription placed;
    surface.body = placed.body = at(frame, "body").name();
    if (surface.body != model::kGround) {
      require_known("body", surface.body, model_.description().bodies);
    }
    if (const auto found = frame.find("translation")) placed.translation = found->vector3();
    if (const auto found = frame.find("orientation_xyz")) placed.orientation_xyz = found->vector3();
    surface.X_BS = model::placement(placed);
    const auto mesh = node.find("mesh");
    if (!mesh) return surface;
    surface.mesh = file_.parent_path() / mesh->name();
    if (!std::filesystem::is_regular_file(surface.mesh)) {
      fail("surface '" + surface.name + "': there is no " + surface.mesh.string());
    }
    return surface;
  }

  std::filesystem::path file_;
  const model::Model& model_;
};

}  // namespace

std::vector<SurfaceFile> read_surface_file(const std::filesystem::path& file,
                                           const model::Model& model) {
  return Reader(file, model).read();
}

const SurfaceFile& find_surface(const std::vector<SurfaceFile>& surfaces, const std::string& name) {
  std::vector<std::string> names;
  for (const SurfaceFile& surface : surfaces) {
    if (surface.name == name) return surface;
    names.push_back(surface.name);
  }
  throw std::invalid_argument("no surface '" + name + "'" + did_you_mean(name, names) +
                              " (surfaces: " + listed(names) + ")");
}

}  // namespace condyle::io
