// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/bus/bus.hpp"
#include "common/process/command_line.hpp"

namespace eti::bus {

/// Adds the options that select a session: --session, --domain, --peer, --network, --discovery-server,
/// --profile, --identity.
void add_options(CommandLine& app, Options& options);

/// Adds --domain alone; add_options() includes it.
Option add_domain(CommandLine& app, Options& options);

}  // namespace eti::bus
