// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include "common/model/landmark.hpp"

namespace eti::render {

/// What grows on, and colours, a newborn's skin, by place and maturity. Places are model coordinates of the
/// patient generator: x left, y anterior, z superior; millimetres of a 3.5 kg newborn in the rest posture.
/// Only its whole body has hands, feet and a face at these places.
class NewbornSkin {
  public:
    /// From the patient's landmarks at rest.
    explicit NewbornSkin(const Landmarks& rest);

    /// Size relative to a newborn of 3.5 kg.
    [[nodiscard]] float size() const { return size_; }
    /// 0 at term, 1 at 28 weeks and below: judged by size.
    [[nodiscard]] float prematurity() const { return prematurity_; }
    [[nodiscard]] Vec3f to_model(const Vec3f& point) const;

    /// Density of hair, 0-1: scalp and brows; below 0.3, lanugo.
    [[nodiscard]] float hair(const Vec3f& model) const;
    /// Hands and feet, 0-1: the last to be perfused.
    [[nodiscard]] float acral(const Vec3f& model) const;
    /// sRGB colour of skin at a place where `sky` of it is visible (folds see less), and its wetness.
    struct Look {
        Vec3f colour;
        float wetness;
    };
    [[nodiscard]] Look look(const Vec3f& model, float sky) const;

  private:
    float size_, prematurity_;
};

}  // namespace eti::render
