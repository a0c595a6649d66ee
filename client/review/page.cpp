// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/report.hpp"

#ifdef ETI_REPORT_PAGE
// Embedded by the assembler, as a compiler would have to parse a string literal of a megabyte.
asm(".section .rodata\n"
    ".global eti_report_page\n"
    ".global eti_report_page_end\n"
    "eti_report_page:\n"
    ".incbin \"" ETI_REPORT_PAGE
    "\"\n"
    "eti_report_page_end:\n"
    ".byte 0\n"
    ".previous\n");
extern "C" const char eti_report_page[], eti_report_page_end[];
#endif

namespace eti::review {

std::string_view report_page() {
#ifdef ETI_REPORT_PAGE
    return {eti_report_page, static_cast<std::size_t>(eti_report_page_end - eti_report_page)};
#else
    return {};
#endif
}

}  // namespace eti::review
