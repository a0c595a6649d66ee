// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/process/files/descriptor.hpp"

namespace eti {

/// This process's part of the processors that several simulations on one machine use. Each announces itself
/// by an abstract Unix socket (unix(7)), which the kernel removes with the process, so that nothing is left
/// by one that was killed. Containers with a network namespace of their own do not see each other; their
/// quotas do what this would.
class ProcessorShare {
  public:
    /// Announces this process until destruction. Where that is not possible, others do not count it.
    ProcessorShare();

    /// Number of announced processes that may run on one of the processors that this process may run on,
    /// itself included.
    [[nodiscard]] static unsigned simulations();
    /// usable_processors() over simulations(), rounded down; at least one.
    [[nodiscard]] static unsigned processors();

  private:
    Descriptor announcement_;
};

}  // namespace eti
