// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/app/annotator.hpp"

#include "client/app/window/special_keys.hpp"
#include "client/text/catalogue.hpp"
#include "common/bus/codec/convert.hpp"
#include "common/model/utf8.hpp"

namespace eti::client {
namespace {

// UTF-8; typed characters are never surrogates.
std::string encoded(char32_t c) {
    const auto byte = [](char32_t bits) { return static_cast<char>(static_cast<unsigned char>(bits)); };
    if (c < 0x80) {
        return {byte(c)};
    }
    if (c < 0x800) {
        return {byte(0xc0 | (c >> 6)), byte(0x80 | (c & 0x3f))};
    }
    if (c < 0x10000) {
        return {byte(0xe0 | (c >> 12)), byte(0x80 | ((c >> 6) & 0x3f)), byte(0x80 | (c & 0x3f))};
    }
    return {byte(0xf0 | (c >> 18)), byte(0x80 | ((c >> 12) & 0x3f)), byte(0x80 | ((c >> 6) & 0x3f)),
            byte(0x80 | (c & 0x3f))};
}

}  // namespace

void Annotator::start(const render::PickHit& at) {
    sketch_ = bus::Annotation{0, msg::ANNOTATION_STROKE, sender_, {}, at.object, {at.place}};
}

void Annotator::begin(const std::optional<render::PickHit>& at) {
    sketch_.reset();
    if (!at || at->object.empty()) {
        error_ = at ? text::translate("the tube cannot be marked: point at tissue or at the blade")
                    : text::translate("nothing to mark there");
        return;
    }
    start(*at);
}

void Annotator::extend(const std::optional<render::PickHit>& at) {
    const bool on_something = at && !at->object.empty();
    if (sketch_ && (!on_something || at->object != sketch_->object)) {
        end();
    }
    if (!on_something) {
        return;
    }
    if (!sketch_) {
        start(*at);
        return;
    }
    sketch_->places.push_back(at->place);
    if (sketch_->places.size() == msg::bound::Annotation_places) {
        end();
        start(*at);
    }
}

void Annotator::end() {
    if (!sketch_) {
        return;
    }
    bus::Annotation mark = std::move(*sketch_);
    sketch_.reset();
    if (mark.places.size() == 1) {
        mark.kind = msg::ANNOTATION_POINT;
        mark.text = std::exchange(words_, std::nullopt).value_or("");
    }
    send(mark);
}

void Annotator::press(char32_t key) {
    if (!words_ || (key >= key_left && key <= key_down)) {
        return;
    }
    if (key == key_escape) {
        words_.reset();
    } else if (key == key_enter) {
        if (!words_->empty()) {
            send({0, msg::ANNOTATION_NOTE, sender_, *words_, {}, {}});
        }
        words_.reset();
    } else if (key == key_backspace) {
        if (!words_->empty()) {
            words_->resize(utf8_prefix_length(*words_, words_->size() - 1));
        }
    } else if (const std::string more = encoded(key);
               key >= U' ' && key != 0x7f && words_->size() + more.size() <= msg::bound::Annotation_text) {
        *words_ += more;
    }
}

void Annotator::wipe() {
    send({0, msg::ANNOTATION_CLEAR, sender_, {}, {}, {}});
}

void Annotator::send(const bus::Annotation& annotation) {
    msg::Annotation message = bus::encode_annotation(annotation);
    message.header(bus::make_header(0, ++number_));
    if (!send_(message)) {
        error_ = text::translate("no server accepts remarks or marks");
    }
}

}  // namespace eti::client
