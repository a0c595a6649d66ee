// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::render {

/// Detects a GPU reset in the context current at construction: a fault, or a GPU that was unplugged or
/// suspended. After a reset nothing that is drawn takes effect.
class ContextLossMonitor {
  public:
    ContextLossMonitor();
    /// Throws std::runtime_error, with the remedy, once the context is lost; never if the driver cannot
    /// report it (lacks both GL_KHR_robustness and GL_ARB_robustness).
    void throw_if_lost() const;

  private:
    enum class ResetQuery { none, core, arb } reset_query_ = ResetQuery::none;
};

}  // namespace eti::render
