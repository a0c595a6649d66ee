// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "close_window.hpp"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace eti::test {

bool close_window(const std::string& title) {
    Display* display = ::XOpenDisplay(nullptr);
    if (display == nullptr) {
        return false;
    }
    Window root = 0, parent = 0, *children = nullptr;
    unsigned int count = 0;
    bool found = false;
    ::XQueryTree(display, ::XDefaultRootWindow(display), &root, &parent, &children, &count);
    for (unsigned int i = 0; i < count && !found; ++i) {
        char* name = nullptr;
        found = ::XFetchName(display, children[i], &name) != 0 && std::string(name).starts_with(title);
        if (name != nullptr) {
            ::XFree(name);
        }
        if (found) {
            XEvent event{};
            event.xclient.type = ClientMessage;
            event.xclient.window = children[i];
            event.xclient.message_type = ::XInternAtom(display, "WM_PROTOCOLS", False);
            event.xclient.format = 32;
            event.xclient.data.l[0] = static_cast<long>(::XInternAtom(display, "WM_DELETE_WINDOW", False));
            ::XSendEvent(display, children[i], False, NoEventMask, &event);
        }
    }
    if (children != nullptr) {
        ::XFree(children);
    }
    ::XCloseDisplay(display);
    return found;
}

}  // namespace eti::test
