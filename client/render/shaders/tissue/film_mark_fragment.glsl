// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// Marks a cell as wet. Defines: none.
out vec4 marked;
void main() { marked = vec4(1.0); }
