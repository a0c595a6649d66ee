// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/gl/context_loss.hpp"

#include <epoxy/gl.h>

#include <stdexcept>

#include <fmt/format.h>

namespace eti::render {
namespace {

const char* cause_of(GLenum status) {
    switch (status) {
        case GL_GUILTY_CONTEXT_RESET:
            return "caused by this program";
        case GL_INNOCENT_CONTEXT_RESET:
            return "caused by another program";
        default:
            return "for an unknown reason";
    }
}

}  // namespace

ContextLossMonitor::ContextLossMonitor() {
    if (epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_KHR_robustness")) {
        reset_query_ = ResetQuery::core;
    } else if (epoxy_has_gl_extension("GL_ARB_robustness")) {
        reset_query_ = ResetQuery::arb;
    }
}

void ContextLossMonitor::throw_if_lost() const {
    const GLenum status = reset_query_ == ResetQuery::core  ? glGetGraphicsResetStatus()
                          : reset_query_ == ResetQuery::arb ? glGetGraphicsResetStatusARB()
                                                            : GL_NO_ERROR;
    if (status != GL_NO_ERROR) {
        throw std::runtime_error(
            fmt::format("the graphics card was reset, {}: rendering cannot continue. Start this program "
                        "again; if it happens again, update the driver, choose a lower --quality, or render "
                        "in software (LIBGL_ALWAYS_SOFTWARE=1).",
                        cause_of(status)));
    }
}

}  // namespace eti::render
