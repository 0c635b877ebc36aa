// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "condyle/contact/implant_check.hpp"
#include "condyle/geometry/mesh_file.hpp"
#include "contact/contact_fixtures.hpp"
#include "support/shared_data.hpp"

using namespace condyle;
using namespace condyle::contact;

namespace {

template <typename Check>
std::string complaint(const Check& check) {
  try {
    check();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

bool begins(const std::string& text, const std::string& with) { return text.rfind(with, 0) == 0; }

}  // namespace

TEST_CASE("inverted surfaces are refused with a remedy, open and closed") {
  const auto open = test::notched_femur();
  const auto closed = test::shifted(test::sphere(0.02, 3), {0.0, 0.01, 0.0});
  CHECK(complaint([&] { require_femur(open); }) == "");
  CHECK(complaint([&] { require_femur(closed); }) == "");
  const std::string text = complaint([&] { require_femur(test::reversed(open)); });
  CHECK(begins(text, "femur: normals point inwards (mean n_y in its lowest tenth is 0.9"));
  CHECK(text.find("reverse its faces") != std::string::npos);
  CHECK(begins(complaint([&] { require_femur(test::reversed(closed)); }),
               "femur: normals point inwards (the closed surface has a volume of -3"));

  InsertMeshes insert = test::dished_insert(10);
  CHECK(complaint([&] { require_insert(insert, SideOfBody::kRight); }) == "");
  insert[kLateral] = test::reversed(insert[kLateral]);
  CHECK(begins(complaint([&] { require_insert(insert, SideOfBody::kRight); }),
               "insert (lateral): normals point inwards (mean n_y in its highest tenth is -0."));
}

TEST_CASE("a femur whose faces disagree, or that branches, is refused") {
  auto femur = test::notched_femur();
  std::swap(femur.faces(1, 1), femur.faces(1, 2));
  CHECK(begins(complaint([&] { require_femur(femur); }),
               "femur: faces disagree on which side is out at 2 edges"));
  femur = test::notched_femur();
  femur.faces.conservativeResize(9, 3);
  femur.faces.row(8) << 0, 2, 6;
  CHECK(begins(complaint([&] { require_femur(femur); }),
               "femur: 1 edges are shared by more than two faces"));
}

TEST_CASE(
    "compartments on the wrong side are refused; which one that is depends on the side of the "
    "body") {
  const InsertMeshes insert = test::plane_insert(4);
  CHECK(complaint([&] { require_insert(insert, SideOfBody::kLeft); }) ==
        "insert (medial): lies about z = -21 mm but in a left knee medial is z > 0: check "
        "side_of_body, and that "
        "medial and lateral are not swapped");
  CHECK(complaint([&] { require_insert({insert[1], insert[0]}, SideOfBody::kLeft); }) == "");
}

TEST_CASE("femur and insert swapped are noticed") {
  const auto femur = test::notched_femur();
  const InsertMeshes insert = test::plane_insert(4);
  CHECK(complaint([&] { require_unswapped(femur, insert); }) == "");
  CHECK(begins(complaint([&] {
                 require_unswapped(insert[0], {femur, femur});
               }),
               "femur: 0 mm high, less than"));
  CHECK(complaint([&] { require_femur(insert[0]); }) != "");
  CHECK(complaint([&] { require_insert({femur, femur}, SideOfBody::kRight); }) != "");
}

TEST_CASE(
    "real implants pass, contact surfaces and solids, and are refused when swapped or inverted") {
  CONDYLE_REQUIRE_DATA(data);
  const auto unit = geometry::LengthUnit::kMetre;
  for (const std::string set : {"dm", "jw"}) {
    for (const std::string kind : {"contact", "solid"}) {
      CAPTURE(set + " " + kind);
      const auto file = [&](const std::string& part) {
        return geometry::read_mesh(data / "implants" / set / (part + ".stl"), unit);
      };
      const auto femur = file("femur_" + kind);
      const InsertMeshes insert{file("insert_" + kind + "_medial"),
                                file("insert_" + kind + "_lateral")};
      const InsertMeshes split = split_insert(file("insert_" + kind), SideOfBody::kRight);
      CHECK(complaint([&] { require_femur(femur); }) == "");
      CHECK(complaint([&] { require_insert(insert, SideOfBody::kRight); }) == "");
      CHECK(complaint([&] { require_insert(split, SideOfBody::kRight); }) == "");
      CHECK(complaint([&] { require_unswapped(femur, split); }) == "");
      CHECK(complaint([&] { require_femur(test::reversed(femur)); }) != "");
      CHECK(complaint([&] {
              require_insert({test::reversed(split[0]), split[1]}, SideOfBody::kRight);
            }) != "");
      CHECK(complaint([&] { require_unswapped(split[0], {femur, femur}); }) != "");
    }
  }
}
