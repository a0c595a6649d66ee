// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <CLI/CLI.hpp>

#include "common/bus/bus.hpp"

namespace eti::bus {

/// The options by which every program finds its session: --session, --domain, --peer, --network,
/// --discovery-server, --profile, --identity.
void add_options(CLI::App& app, Options& options);

/// --domain alone, which add_options() adds with the others.
CLI::Option* add_domain(CLI::App& app, Options& options);

}  // namespace eti::bus
