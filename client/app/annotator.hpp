// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "client/render/pick.hpp"
#include "client/view/annotations.hpp"

namespace eti::client {

/// Turns clicks, drags and typed words into annotations and sends them.
class Annotator {
  public:
    /// Publishes one; false: no server takes it.
    using Send = std::function<bool(const msg::Annotation&)>;

    Annotator(std::string sender, Send send) : sender_(std::move(sender)), send_(std::move(send)) {}

    // A mark is begun at a place, led on, and ended: one that went nowhere is a point. Where it leaves an
    // object it ends, and another begins on the next; so it does where a message is full.
    void begin(const std::optional<render::Picked>& at);
    void lead(const std::optional<render::Picked>& at);
    void end();

    /// Words are being written: press() takes every key, and the next point stands beside them.
    void write() { words_.emplace(); }
    [[nodiscard]] bool writing() const { return words_.has_value(); }
    [[nodiscard]] const std::string& words() const { return *words_; }
    /// A character as typed, or key_enter, key_backspace, key_escape of window.hpp.
    void press(char32_t key);

    void wipe();

    /// The mark that has not been sent yet.
    [[nodiscard]] const std::optional<view::Annotation>& sketch() const { return sketch_; }
    /// What went wrong since last asked; else empty.
    [[nodiscard]] std::string take_trouble() { return std::exchange(trouble_, {}); }

  private:
    void start(const render::Picked& at);
    void send(msg::AnnotationKind kind, std::string text, const view::Annotation* mark);

    std::string sender_;
    Send send_;
    std::optional<view::Annotation> sketch_;
    std::optional<std::string> words_;
    std::string trouble_;
    std::uint32_t number_ = 0;
};

}  // namespace eti::client
