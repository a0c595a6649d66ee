// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "client/render/views/pick.hpp"
#include "client/view/annotations.hpp"

namespace eti::client {

/// Turns clicks, drags and typed text into annotations and sends them.
class Annotator {
  public:
    /// Publishes an annotation; returns false if no server is subscribed.
    using Send = std::function<bool(const msg::Annotation&)>;

    Annotator(std::string sender, Send send) : sender_(std::move(sender)), send_(std::move(send)) {}

    // A mark that does not move is a point. A mark ends where it leaves an object or fills a message; a new
    // one begins on the next object or in the next message.
    void begin(const std::optional<render::PickHit>& at);
    void extend(const std::optional<render::PickHit>& at);
    void end();

    /// Starts text entry: press() receives every key, and the next point carries the text.
    void write() { words_.emplace(); }
    [[nodiscard]] bool writing() const { return words_.has_value(); }
    [[nodiscard]] const std::string& words() const { return *words_; }
    /// A typed character, or key_enter, key_backspace or key_escape of window.hpp.
    void press(char32_t key);

    void wipe();

    /// The mark being drawn, not sent yet.
    [[nodiscard]] const std::optional<bus::Annotation>& sketch() const { return sketch_; }
    /// The error since the last call; empty if none.
    [[nodiscard]] std::string take_error() { return std::exchange(error_, {}); }

  private:
    void start(const render::PickHit& at);
    void send(const bus::Annotation& annotation);

    std::string sender_;
    Send send_;
    std::optional<bus::Annotation> sketch_;
    std::optional<std::string> words_;
    std::string error_;
    std::uint32_t number_ = 0;
};

}  // namespace eti::client
