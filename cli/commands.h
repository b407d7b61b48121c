// The subcommands: each function adds one to the program; the chosen one sets `invocation.command`.
#pragma once

#include <CLI/App.hpp>

#include "cli/context.h"

namespace dmvv::cli {

void add_new(CLI::App& app, Invocation& invocation);
void add_check(CLI::App& app, Invocation& invocation);
void add_fmt(CLI::App& app, Invocation& invocation);
void add_render(CLI::App& app, Invocation& invocation);
void add_animate(CLI::App& app, Invocation& invocation);
void add_probe(CLI::App& app, Invocation& invocation);
void add_compile(CLI::App& app, Invocation& invocation);
void add_info(CLI::App& app, Invocation& invocation);
void add_sdf(CLI::App& app, Invocation& invocation);
void add_mesh(CLI::App& app, Invocation& invocation);
void add_seeds(CLI::App& app, Invocation& invocation);
void add_bench(CLI::App& app, Invocation& invocation);

}  // namespace dmvv::cli
