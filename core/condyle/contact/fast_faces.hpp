// SPDX-License-Identifier: Apache-2.0
// A surface's faces arranged for the fast kernel: sorted so that neighbours are neighbours in
// memory, in two levels of balls that can be culled at once, structure of arrays.
#pragma once

#include <cstdint>
#include <vector>

#include "condyle/contact/fast_kernel.hpp"
#include "condyle/contact/surface_faces.hpp"
#include "condyle/geometry/distance_field.hpp"

namespace condyle::contact::fast {

/// Owns the arrays that a FacesView and a ClustersView look at.
class SortedFaces {
 public:
  /// Faces without area are left out: they add to no sum. The order depends on the faces only.
  explicit SortedFaces(const SurfaceFaces& faces);

  FacesView faces() const;
  ClustersView clusters() const;
  /// Of each sorted face, which one of the caller's it is; padding repeats the last.
  const std::vector<std::int32_t>& order() const { return order_; }

 private:
  std::vector<std::int32_t> order_;
  std::vector<double> x_, y_, z_, nx_, ny_, nz_, area_;
  std::vector<Cluster> parents_, leaves_;
};

/// A field as the kernel sees it. @pre it outlives the view.
FieldView field_view(const geometry::DistanceField& field);

}  // namespace condyle::contact::fast
