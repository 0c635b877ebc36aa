// SPDX-License-Identifier: Apache-2.0
#include "condyle/surrogate/module_folder.hpp"

#include <dlfcn.h>
#include <link.h>
#include <sys/auxv.h>

#include <system_error>

namespace condyle::surrogate {

namespace fs = std::filesystem;

fs::path module_folder() {
  Dl_info info{};
  link_map* map = nullptr;
  const auto* here = reinterpret_cast<const void*>(&module_folder);
  if (dladdr1(here, &info, reinterpret_cast<void**>(&map), RTLD_DL_LINKMAP) == 0) return {};
  std::error_code error;
  if (map != nullptr && map->l_name != nullptr && map->l_name[0] != '\0') {
    return fs::absolute(map->l_name, error).parent_path();
  }
  // The main program has no name in the link map, and dladdr gives argv[0], which may be a bare
  // word. /proc tells the file; a bare chroot has no /proc, but the kernel also left the name that
  // was executed in the auxiliary vector.
  const fs::path executable = fs::read_symlink("/proc/self/exe", error);
  if (!error) return executable.parent_path();
  const auto* executed = reinterpret_cast<const char*>(getauxval(AT_EXECFN));
  return executed == nullptr ? fs::path{} : fs::absolute(executed, error).parent_path();
}

}  // namespace condyle::surrogate
