// SPDX-License-Identifier: Apache-2.0
// Whether a model description makes sense item by item: names, references, numbers. The tree itself
// is `Model`'s to check.
#pragma once

#include <string>

#include "condyle/model/model_description.hpp"

namespace condyle::model {

/// What messages call the model: its source, else its name.
std::string model_label(const ModelDescription& description);

/// @throws std::invalid_argument "source: item 'name': field is value; limit" for the first thing
/// found wrong.
void require_valid(const ModelDescription& description);

}  // namespace condyle::model
