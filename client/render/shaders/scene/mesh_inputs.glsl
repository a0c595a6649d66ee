// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Inputs of a mesh's fragment shader; include before the lighting. Defines: none.
in vec3 world;
in vec3 normal_at;
