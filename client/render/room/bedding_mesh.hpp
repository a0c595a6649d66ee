// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "client/render/gl/gl_object.hpp"
#include "client/render/room/bedding.hpp"

namespace eti::render {

/// A bedding on the GPU, 12 bytes per vertex and update: height, normal, and colour.
class BeddingMesh {
  public:
    explicit BeddingMesh(const Bedding& bedding);

    /// Uploads the first rows.
    void update(const Bedding& bedding, int rows);
    void draw(bool coarse) const;

  private:
    struct Range {
        GLsizei count = 0;
        std::size_t offset = 0;  ///< [bytes]
    };

    VertexArray array_;
    Buffer places_, surface_, indices_;
    Range fine_, coarse_;
};

}  // namespace eti::render
