// SPDX-License-Identifier: Apache-2.0
// condyle-sim: contact loads and knee simulations without Python.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>

#include "condyle/surrogate/onnx_session.hpp"
#include "condyle/surrogate/onnxruntime_library.hpp"
#include "subcommands.hpp"

namespace {

/// The end of --help: which onnxruntime serves --surrogate, or why none does.
std::string onnxruntime_line() {
  try {
    const std::string version = condyle::surrogate::onnxruntime_version();
    return "onnxruntime in use: " + condyle::surrogate::onnxruntime_library() + " (" + version +
           ")";
  } catch (const std::exception& error) {
    return std::string("onnxruntime in use: none, so no --surrogate. ") + error.what();
  }
}

int complain(const std::string& message) {
  std::cerr << "condyle-sim: " << message << '\n';
  return condyle::apps::kUserMistake;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Contact and simulation of knee replacements", "condyle-sim");
  program.set_version_flag("--version", "condyle-sim " CONDYLE_VERSION);
  program.require_subcommand(1);
  program.footer(onnxruntime_line);
  int exit_code = 0;
  condyle::apps::add_contact(program);
  condyle::apps::add_simulate(program, exit_code);
  condyle::apps::add_surrogate(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& wanted) {  // --help, --version
    return program.exit(wanted);
  } catch (const std::exception& error) {
    return complain(error.what());
  }
  return exit_code;
}
