// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Light that arrives at `world`; include before the fragment shader's own code. Defines: those of
// `lights` and `shadows`.
#include "scene/lights.glsl"
#include "scene/shadows.glsl"
#include "scene/arrivals.glsl"
