// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "common/hdf5/group.hpp"

namespace eti::session {

/// A data set of texts in a group of equally long ones: one field of a row.
template <class Row>
struct TextColumn {
    const char* name;
    const char* description;
    std::string Row::*value;
};

template <class Row, std::size_t N>
void write_text_columns(const hdf5::Group& group, const std::vector<Row>& rows,
                        const TextColumn<Row> (&columns)[N]) {
    for (const TextColumn<Row>& column : columns) {
        std::vector<std::string> texts;
        for (const Row& row : rows) {
            texts.push_back(row.*column.value);
        }
        group.write_texts(column.name, texts, {"1", column.description});
    }
}

template <class Row, std::size_t N>
[[nodiscard]] std::vector<Row> read_text_columns(const hdf5::Group& group,
                                                 const TextColumn<Row> (&columns)[N]) {
    std::vector<Row> rows;
    for (const TextColumn<Row>& column : columns) {
        const std::vector<std::string> texts = group.read_texts(column.name);
        if (&column == columns) {
            rows.resize(texts.size());
        }
        if (texts.size() != rows.size()) {
            throw hdf5::Error(fmt::format("{}: {} texts, expected {} as in {}", group.at(column.name),
                                          texts.size(), rows.size(), columns[0].name));
        }
        for (std::size_t i = 0; i < rows.size(); ++i) {
            rows[i].*column.value = texts[i];
        }
    }
    return rows;
}

}  // namespace eti::session
