#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Writes what the message generator leaves out: wire.py eti.idl OUT.hpp STRUCTS

STRUCTS is the generated header, as OUT.hpp includes it.

From the IDL come the list of messages, the bound of every sequence by its name, a walk over the members of every
struct, and whole(), which checks a payload before it is read. The generated reader checks no bound, and it
allocates sequences of structs as announced.
"""

import re
import sys
from pathlib import Path

SIZES = {"boolean": 1, "octet": 1, "short": 2, "unsigned short": 2, "long": 4, "unsigned long": 4, "float": 4,
         "unsigned long long": 8, "double": 8}
STRUCT = re.compile(r"@final\s+struct\s+(\w+)\s*\{(.*?)\}\s*;", re.S)
ENUM = re.compile(r"enum\s+(\w+)\s*\{(.*?)\}\s*;", re.S)
SEQUENCE = re.compile(r"sequence<\s*(.*?)\s*(?:,\s*(\d+))?\s*>$")
STRING = re.compile(r"string(?:<(\d+)>)?$")
MEMBER = re.compile(r"(?:@key\s+)?(.+?)\s+(\w+)")


def parse(text):
    """Enumerators by enum, and (type, name) members by struct, in their order."""
    text = re.sub(r"//[^\n]*", "", text)
    enums = {m[1]: m[2].split(",") for m in ENUM.finditer(text)}
    structs = {}
    for m in STRUCT.finditer(text):
        lines = [re.sub(r"\s*>", ">", " ".join(part.split())) for part in m[2].split(";")]
        structs[m[1]] = [MEMBER.fullmatch(line).groups() for line in lines if line]
    return enums, structs


class Writer:
    """C++ of one IDL; unknown types raise KeyError."""

    def __init__(self, enums, structs):
        self.enums, self.structs = enums, structs
        self.messages = [name for name, members in structs.items() if ("Header", "header") in members]

    def bound(self, kind):
        """Elements of a sequence, letters of a string, enumerators of an enum; else no_bound."""
        if sequence := SEQUENCE.match(kind):
            return sequence[2] or "no_bound"
        if string := STRING.match(kind):
            return string[1] or "no_bound"
        return str(len(self.enums[kind])) if kind in self.enums else "no_bound"

    def walk(self, kind):
        """A condition that steps over one `kind` of the payload `in`."""
        if sequence := SEQUENCE.match(kind):
            if sequence[1] in SIZES:
                return f"in.numbers({self.bound(kind)}, {SIZES[sequence[1]]})"
            return f"in.each({self.bound(kind)}, [&] {{ return {self.walk(sequence[1])}; }})"
        if STRING.match(kind):
            return f"in.text({self.bound(kind)})"
        if kind in self.enums:
            return f"in.choice({self.bound(kind)})"
        return f"whole_{kind}(in)" if kind in self.structs else f"in.number({SIZES[kind]})"

    def struct(self, name):
        """The struct's walk over members, and over a payload."""
        members = self.structs[name]
        visits = [f'    visit("{member}", message.{member}(), {self.bound(kind)});' for kind, member in members]
        walks = " &&\n           ".join(self.walk(kind) for kind, _ in members)
        return [f"template <class Message, class Visit>",
                f"    requires std::same_as<std::remove_const_t<Message>, {name}>",
                "void for_members(Message& message, Visit&& visit) {", *visits, "}",
                "template <class Payload>", f"[[nodiscard]] bool whole_{name}(Payload& in) {{", f"    return {walks};",
                "}"]

    def text(self, structs):
        out = ["// Written by idl/wire.py.", "#pragma once", "", "#include <concepts>", "#include <cstddef>",
               "#include <cstdint>", "#include <type_traits>", "", f'#include "{structs}"', "",
               "/// X(name) of every message: of every struct with a header.", "#define ETI_MESSAGES(X) \\",
               " \\\n".join(f"    X({name})" for name in self.messages), "", "namespace eti::msg {", "",
               "// Enumerators are in this namespace, as in the IDL: some generators scope them to their enum.",
               *(f"using enum {name};" for name in self.enums), "",
               "inline constexpr std::size_t no_bound = SIZE_MAX;", "",
               "/// How many elements a sequence may have, or letters a string: struct and member.", "namespace bound {"]
        out += [f"inline constexpr std::size_t {name}_{member} = {self.bound(kind)};"
                for name, members in self.structs.items() for kind, member in members
                if kind not in self.enums and self.bound(kind) != "no_bound"]
        out += ["}  // namespace bound", "",
                "// for_members: visit(name, member, bound) of each member in its order; the bound is that of a sequence or",
                "// string, or the count of an enum's values. whole: whether a payload holds the struct within its bounds."]
        for name in self.structs:
            out += self.struct(name)
        for name in self.messages:
            out += ["template <class Payload>", f"[[nodiscard]] bool whole(Payload& in, const {name}*) {{",
                    f"    return whole_{name}(in);", "}"]
        return "\n".join(out + ["", "}  // namespace eti::msg", ""])


def main():
    source, target, structs = sys.argv[1:]
    parts = parse(Path(source).read_text(encoding="utf-8"))
    Path(target).write_text(Writer(*parts).text(structs), encoding="utf-8")


if __name__ == "__main__":
    main()
