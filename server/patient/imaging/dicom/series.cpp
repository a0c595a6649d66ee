// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "server/patient/imaging/dicom/series.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "common/process/escaped.hpp"

namespace eti::imaging {

namespace {

/// Whether the images' rows and columns run alike, up to a scanner's rounding.
bool same_directions(const Geometry& a, const Geometry& b) {
    constexpr double rounded = 0.01;
    for (int k = 0; k < 2; ++k) {
        if ((a.step.col(k).normalized() - b.step.col(k).normalized()).norm() > rounded) {
            return false;
        }
    }
    return true;
}

/// Leaves out images in another direction than most.
void keep_one_direction(DicomSeries& series) {
    std::vector<std::vector<DicomHeader>> groups;
    for (DicomHeader& slice : series.files) {
        const auto like = std::ranges::find_if(groups, [&](const auto& group) {
            return same_directions(group.front().geometry, slice.geometry);
        });
        if (like == groups.end()) {
            groups.push_back({std::move(slice)});
        } else {
            like->push_back(std::move(slice));
        }
    }
    const std::size_t all = series.files.size();
    series.files = std::move(*std::ranges::max_element(groups, {}, &std::vector<DicomHeader>::size));
    series.in_other_directions = all - series.files.size();
}

void sort_along_normal(std::vector<DicomHeader>& slices) {
    const Geometry& first = slices.front().geometry;
    const Vec3d normal = first.step.col(0).cross(first.step.col(1)).normalized();
    std::ranges::stable_sort(slices, {},
                             [&](const DicomHeader& slice) { return slice.geometry.origin.dot(normal); });
}

/// "gaps of 4.22 and 7.38 mm", each once, the usual one first; a range if there are many.
std::string gaps_text(double usual, const std::vector<double>& others) {
    std::vector<std::string> texts{fmt::format("{:.2f}", 1e3 * usual)};
    for (const double gap : others) {
        if (const std::string text = fmt::format("{:.2f}", 1e3 * gap); !std::ranges::count(texts, text)) {
            texts.push_back(text);
        }
    }
    constexpr std::size_t most = 4;
    if (texts.size() > most) {
        const auto [least, greatest] = std::ranges::minmax(others);
        return fmt::format("gaps from {:.2f} to {:.2f} mm", 1e3 * std::min(least, usual),
                           1e3 * std::max(greatest, usual));
    }
    const std::string last = texts.back();
    texts.pop_back();
    return fmt::format("gaps of {} and {} mm", fmt::join(texts, ", "), last);
}

std::string list_of(const std::vector<DicomSeries>& all) {
    std::string list;
    for (const DicomSeries& series : all) {
        list += fmt::format("{}{}", list.empty() ? "" : ", ", series.label());
    }
    return list;
}

}  // namespace

std::size_t DicomSeries::slices() const {
    std::size_t count = 0;
    for (const DicomHeader& file : files) {
        count += static_cast<std::size_t>(file.geometry.size[2]);
    }
    return count;
}

std::string DicomSeries::label() const {
    const std::string shown = description.empty() ? "" : fmt::format("'{}', ", escaped(description, 64));
    return fmt::format("{} ({}{} {})", name.empty() ? "without a UID" : escaped(name, 64), shown, slices(),
                       slices() == 1 ? "slice" : "slices");
}

std::optional<SeriesFault> find_series_fault(const std::vector<std::string>& files,
                                             const std::vector<Geometry>& geometries,
                                             const std::string& folder) {
    const Geometry& first = geometries.front();
    for (std::size_t i = 0; i < files.size(); ++i) {
        const Geometry& g = geometries[i];
        if (g.size[0] != first.size[0] || g.size[1] != first.size[1] ||
            (g.step - first.step).norm() > 1e-3 * first.step.norm()) {
            return SeriesFault{files[i], "size, spacing or direction differ from the series' first slice",
                               "the same", "export one series with one field of view"};
        }
    }
    if (files.size() < 2) {
        return std::nullopt;
    }
    std::vector<Vec3d> gaps;
    for (std::size_t i = 0; i + 1 < files.size(); ++i) {
        gaps.emplace_back(geometries[i + 1].origin - geometries[i].origin);
    }
    std::vector<Vec3d> by_length = gaps;
    std::ranges::sort(by_length, {}, [](const Vec3d& gap) { return gap.norm(); });
    const Vec3d usual = by_length[by_length.size() / 2];
    std::vector<double> others;
    std::size_t where = 0;
    for (std::size_t i = 0; i < gaps.size(); ++i) {
        if (!(gaps[i].norm() > 1e-6)) {
            return SeriesFault{
                folder, fmt::format("{} and {} are at the same position", files[i], files[i + 1]),
                "one slice at each position",
                "a slice is duplicated, or the series contains several phases; export one of them"};
        }
        if (!((gaps[i] - usual).norm() <= 0.1 * usual.norm())) {
            where = others.empty() ? i : where;
            others.push_back(gaps[i].norm());
        }
    }
    if (others.empty()) {
        return std::nullopt;
    }
    return SeriesFault{
        folder,
        fmt::format("{} between slices, the first of {:.2f} mm between {} and {}",
                    gaps_text(usual.norm(), others), 1e3 * others.front(), files[where], files[where + 1]),
        "equal distances",
        "a slice is missing, or the scan has several spacings; export the whole series again, "
        "or resample it to one spacing"};
}

std::vector<DicomSeries> sort_by_series(std::vector<DicomHeader> slices, const std::string& folder) {
    std::map<std::string, DicomSeries> sorted;
    for (DicomHeader& slice : slices) {
        DicomSeries& series = sorted[slice.series];
        series.name = slice.series;
        series.description = slice.description;
        series.files.push_back(std::move(slice));
    }
    std::vector<DicomSeries> all;
    for (auto& [name, series] : sorted) {
        const bool frames = std::ranges::any_of(
            series.files, [](const DicomHeader& file) { return file.geometry.size[2] > 1; });
        if (frames && series.files.size() > 1) {
            series.fault =
                SeriesFault{series.files.front().file, "the series has a multi-frame file and other files",
                            "one multi-frame file or a folder of slices", "give the file itself"};
        } else if (!frames) {
            keep_one_direction(series);
            sort_along_normal(series.files);
            std::vector<std::string> files;
            std::vector<Geometry> geometries;
            for (const DicomHeader& slice : series.files) {
                files.push_back(slice.file);
                geometries.push_back(slice.geometry);
            }
            series.fault = find_series_fault(files, geometries, folder);
        }
        all.push_back(std::move(series));
    }
    return all;
}

const DicomSeries& choose_series(const std::vector<DicomSeries>& all, const std::string& wanted,
                                 const std::string& folder) {
    if (!wanted.empty()) {
        const auto found = std::ranges::find(all, wanted, &DicomSeries::name);
        if (found == all.end()) {
            refuse_dicom(folder, fmt::format("there is no CT series '{}'", escaped(wanted, 64)),
                         "one of " + list_of(all), "give one of them with --series");
        }
        return *found;
    }
    constexpr std::size_t least = 4;  // as require_valid()
    const DicomSeries* best = nullptr;
    bool tied = false;
    for (const bool whole : {true, false}) {
        for (const DicomSeries& series : all) {
            if (whole && (series.fault || series.slices() < least)) {
                continue;
            }
            tied = best != nullptr && series.slices() == best->slices() ? true : tied;
            if (best == nullptr || series.slices() > best->slices()) {
                best = &series;
                tied = false;
            }
        }
        if (best != nullptr) {
            break;
        }
    }
    if (tied) {
        refuse_dicom(
            folder, fmt::format("there are {} CT series: {}", all.size(), list_of(all)),
            "one that has most slices",
            "choose one with --series and its UID; a soft kernel suits the tongue better than a sharp one");
    }
    return *best;
}

}  // namespace eti::imaging
