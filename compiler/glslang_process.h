// Inside compiler: what the users of glslang share.
#pragma once

#include <glslang/Public/ShaderLang.h>

namespace dmvv::compiler {

/// glslang wants one initialisation a process; call this before its first use. Thread-safe.
inline void use_glslang() {
  struct Process {
    Process() { glslang::InitializeProcess(); }
    ~Process() { glslang::FinalizeProcess(); }
  };
  static const Process process;
}

}  // namespace dmvv::compiler
