// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/bus/bus.hpp"
#include "common/process/command_line.hpp"

namespace eti::bus {

/// The options by which every program finds its session: --session, --domain, --peer, --network,
/// --discovery-server, --profile, --identity.
void add_options(CommandLine& app, Options& options);

/// --domain alone, which add_options() adds with the others.
Option add_domain(CommandLine& app, Options& options);

}  // namespace eti::bus
