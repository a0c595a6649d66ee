// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

// Must precede OpenXR's headers, which declare OpenGL and EGL parts only on request.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#define XR_USE_GRAPHICS_API_OPENGL
#define XR_USE_PLATFORM_EGL
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>
