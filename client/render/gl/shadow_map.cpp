// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/render/gl/shadow_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "client/render/views/camera.hpp"

namespace eti::render {

ShadowMap::ShadowMap(int size, OutsideShadowMap beyond) : size_(size) {
    glBindTexture(GL_TEXTURE_2D, depth_.name());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, size, size, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT,
                 nullptr);
    set_filter(GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    const float border = beyond == OutsideShadowMap::lit ? 1.0f : 0.0f;
    const std::array<float, 4> depth{border, border, border, border};
    glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, depth.data());
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth_.name(), 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    const GLenum state = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (state != GL_FRAMEBUFFER_COMPLETE) {
        throw std::runtime_error(
            "the OpenGL driver cannot render to a depth texture; it does not support OpenGL 3.3");
    }
}

void ShadowMap::begin(const Eigen::Matrix4f& world_to_light, std::uint64_t state) {
    world_to_light_ = world_to_light;
    state_ = state;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_, size_);
    glDisable(GL_SCISSOR_TEST);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
}

void ShadowMap::bind_texture(GLenum unit) const {
    glActiveTexture(unit);
    glBindTexture(GL_TEXTURE_2D, depth_.name());
}

Eigen::Matrix4f directional_light_matrix(const Light& light, const Vec3f& centre, float radius) {
    Camera from_light;
    from_light.eye = centre - radius * 2.0f * (centre - light.position).normalized();
    from_light.target = centre;
    from_light.up = Vec3f::UnitZ();
    Eigen::Matrix4f parallel = Eigen::Matrix4f::Identity();
    parallel(0, 0) = parallel(1, 1) = 1.0f / radius;
    // Depth range 0 to 4 radii in front of the light's eye.
    parallel(2, 2) = -1.0f / (2.0f * radius);
    parallel(2, 3) = -1.0f;
    return parallel * from_light.view();
}

Eigen::Matrix4f world_to_lamp(const Light& lamp) {
    Camera from_lamp;
    from_lamp.eye = lamp.position;
    from_lamp.target = lamp.position - lamp.direction;
    from_lamp.up = lamp.direction.unitOrthogonal();
    return from_lamp.view();
}

}  // namespace eti::render
