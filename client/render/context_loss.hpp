// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

namespace eti::render {

/// Looks whether the graphics card was reset under the context that is current when it is made: by a fault,
/// or because it was unplugged or put to sleep. From then on nothing that is drawn arrives anywhere.
class ContextLoss {
  public:
    ContextLoss();
    /// Throws std::runtime_error, with the remedy, once the context is lost. Where the driver cannot tell
    /// (without GL_KHR_robustness and GL_ARB_robustness), never.
    void refuse() const;

  private:
    enum class Asks { nobody, core, arb } asks_ = Asks::nobody;
};

}  // namespace eti::render
