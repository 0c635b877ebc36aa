// SPDX-License-Identifier: Apache-2.0
// condyle-sim surrogate info: what a surrogate file says of itself.
#include <iostream>
#include <memory>
#include <string>

#include "condyle/surrogate/onnx_contact_model.hpp"
#include "subcommands.hpp"

namespace condyle::apps {
namespace {

void print_info(const std::string& file) {
  const surrogate::OnnxContactModel model(file);
  std::cout << "file: " << file << "\noutputs: wrench"
            << (model.has_stiffness() ? ", stiffness, error, trust" : "")
            << "\nruntime: " << name(model.runtime()) << '\n';
  if (!model.instruction_set().empty()) {
    std::cout << "instruction set: " << model.instruction_set() << '\n';
  }
  if (!model.fused_refusal().empty()) {
    std::cout << "not fused, because: " << model.fused_refusal() << '\n';
  }
  for (const auto& [key, value] : model.metadata()) std::cout << key << ": " << value << '\n';
}

}  // namespace

void add_surrogate(CLI::App& program) {
  auto file = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand("surrogate", "Surrogate files");
  command->require_subcommand(1);
  CLI::App* info = command->add_subcommand("info", "Prints what a surrogate file says of itself");
  info->add_option("file", *file, "Surrogate file (.onnx)")->required();
  info->callback([file] { print_info(*file); });
}

}  // namespace condyle::apps
