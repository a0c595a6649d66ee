// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "client/review/export.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

#include "common/process/files/atomic_file_writer.hpp"
#include "common/process/files/folder.hpp"
#include "common/session/opinions.hpp"
#include "common/session/reader.hpp"

namespace eti::review {

namespace {

using session::Series;

/// A CSV file that appears under its name only when complete.
class CsvFile {
  public:
    explicit CsvFile(const std::filesystem::path& path) : path_(path), unfinished_(path) {
        refuse_existing(path, "--out");
        file_.reset(std::fopen(unfinished_.path().c_str(), "wb"));
        if (!file_) {
            fail();
        }
    }

    fmt::memory_buffer& line() { return line_; }

    void end_line() {
        line_.push_back('\r');
        line_.push_back('\n');
        if (std::fwrite(line_.data(), 1, line_.size(), file_.get()) != line_.size()) {
            fail();
        }
        line_.clear();
    }

    void close() {
        if (std::fclose(file_.release()) != 0) {
            fail();
        }
        try {
            unfinished_.finish();
        } catch (const std::filesystem::filesystem_error& error) {
            throw ExportError(fmt::format("{}: {}", path_.string(), error.code().message()));
        }
    }

  private:
    [[noreturn]] void fail() {
        throw ExportError(
            fmt::format("{}: cannot write: {}; free some space or choose another folder with --out",
                        path_.string(), std::strerror(errno)));
    }

    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::filesystem::path path_;
    AtomicFileWriter unfinished_;
    std::unique_ptr<std::FILE, Close> file_;
    fmt::memory_buffer line_;
};

void put_text(fmt::memory_buffer& line, const std::string& text) {
    line.append(csv_text(text));
}

void put_number(fmt::memory_buffer& line, double value) {
    // 9 digits distinguish any two floats, and exceed the useful precision of doubles here.
    fmt::format_to(std::back_inserter(line), "{:.9g}", value);
}

constexpr std::array<const char*, 7> pose_parts{"x", "y", "z", "qw", "qx", "qy", "qz"};

/// Column names of a series: name, component, unit.
std::vector<std::string> titles(const Series& series, const std::string& group) {
    std::string name = series.path.substr(group.size() + 1);
    std::replace(name.begin(), name.end(), '/', '_');
    const std::size_t count = series.row_size();
    std::vector<std::string> all;
    for (std::size_t i = 0; i < count; ++i) {
        std::string_view unit = series.units;
        std::string part;
        if (series.row_shape.size() == 1 && count == 7) {
            part = fmt::format("_{}", pose_parts[i]);
            unit = i < 3 ? "m" : "1";
        } else if (series.row_shape.size() == 1 && count == 4) {
            part = fmt::format("_{}", pose_parts[3 + i]);
        } else if (series.row_shape.size() == 1 && count == 3) {
            part = fmt::format("_{}", pose_parts[i]);
        } else if (series.row_shape.size() == 2) {
            part = fmt::format("_{}_{}", i / series.row_shape[1], pose_parts[i % series.row_shape[1] % 3]);
        } else if (count > 1) {
            part = fmt::format("_{}", i);
        }
        all.push_back(unit == "1" || unit.empty() ? name + part : fmt::format("{}{} [{}]", name, part, unit));
    }
    return all;
}

bool is_time(const Series& series) {
    return series.path.ends_with("/time_ns");
}

/// Files of one export. A failure removes them: some tables of a session look like all of them.
class OutputFolder {
  public:
    explicit OutputFolder(const std::filesystem::path& folder)
        : folder_(folder), is_new_(!std::filesystem::exists(folder)) {
        make_folder(folder);
    }
    ~OutputFolder() {
        std::error_code ignored;
        for (const std::filesystem::path& path : written) {
            std::filesystem::remove(path, ignored);
        }
        if (is_new_ && !kept_) {
            std::filesystem::remove(folder_, ignored);  // only if it is empty
        }
    }
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

    std::vector<std::filesystem::path> keep() {
        kept_ = true;
        return std::exchange(written, {});
    }

    std::vector<std::filesystem::path> written;

  private:
    std::filesystem::path folder_;
    bool is_new_ = false;
    bool kept_ = false;
};

/// False if stopped.
bool write_table(const std::filesystem::path& path, const std::string& group,
                 const std::vector<const Series*>& columns, const std::function<bool()>& stop) {
    CsvFile csv(path);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        if (c > 0) {
            csv.line().push_back(',');
        }
        if (is_time(*columns[c])) {
            fmt::format_to(std::back_inserter(csv.line()), "time [s]");
            continue;
        }
        const auto names = titles(*columns[c], group);
        fmt::format_to(std::back_inserter(csv.line()), "{}", fmt::join(names, ","));
    }
    csv.end_line();
    const std::size_t rows = columns.empty() ? 0 : columns[0]->rows();
    for (std::size_t row = 0; row < rows; ++row) {
        if (stop()) {
            return false;
        }
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const Series& series = *columns[c];
            const std::size_t size = series.row_size();
            for (std::size_t i = 0; i < size; ++i) {
                if (c + i > 0) {
                    csv.line().push_back(',');
                }
                if (!series.texts.empty()) {
                    put_text(csv.line(), series.texts[row]);
                } else if (is_time(series)) {
                    fmt::format_to(std::back_inserter(csv.line()), "{:.9f}", series.values[row] * 1e-9);
                } else {
                    put_number(csv.line(), series.values[row * size + i]);
                }
            }
        }
        csv.end_line();
    }
    csv.close();
    return true;
}

/// One row per frame that moved. False if stopped.
bool write_deformation(const std::filesystem::path& path, const session::SessionReader& reader,
                       const std::function<bool()>& stop) {
    CsvFile csv(path);
    fmt::format_to(std::back_inserter(csv.line()),
                   "time [s],frame,centre_x [m],centre_y [m],centre_z [m],qw,qx,qy,qz");
    csv.end_line();
    for (const session::DeformationRecord& record : reader.deformations()) {
        for (std::size_t i = 0; i < record.frame.size(); ++i) {
            if (stop()) {
                return false;
            }
            const FramePose& pose = record.pose[i];
            fmt::format_to(
                std::back_inserter(csv.line()), "{:.9f},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}",
                static_cast<double>(record.time_ns) * 1e-9, record.frame[i], pose.centre.x(), pose.centre.y(),
                pose.centre.z(), pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z());
            csv.end_line();
        }
    }
    csv.close();
    return true;
}

/// One row per particle of liquid. False if stopped.
bool write_fluid(const std::filesystem::path& path, const session::SessionReader& reader,
                 const std::function<bool()>& stop) {
    CsvFile csv(path);
    fmt::format_to(std::back_inserter(csv.line()), "time [s],x [m],y [m],z [m]");
    csv.end_line();
    for (const session::FluidRecord& record : reader.fluids()) {
        for (const Vec3f& position : record.position) {
            if (stop()) {
                return false;
            }
            fmt::format_to(std::back_inserter(csv.line()), "{:.9f},{:.9g},{:.9g},{:.9g}",
                           static_cast<double>(record.time_ns) * 1e-9, position.x(), position.y(),
                           position.z());
            csv.end_line();
        }
    }
    csv.close();
    return true;
}

/// One row per place of an annotation. False if stopped.
bool write_annotations(const std::filesystem::path& path, const session::SessionReader& reader,
                       const std::function<bool()>& stop) {
    CsvFile csv(path);
    fmt::format_to(std::back_inserter(csv.line()),
                   "time [s],kind,sender,text,object,triangle,u,v,height [m],x [m],y [m],z [m]");
    csv.end_line();
    for (const session::AnnotationRecord& record : reader.annotations()) {
        for (std::size_t i = 0; i < record.place.size(); ++i) {
            if (stop()) {
                return false;
            }
            fmt::format_to(std::back_inserter(csv.line()), "{:.9f}",
                           static_cast<double>(record.time_ns) * 1e-9);
            for (const std::string* text : {&record.kind, &record.sender, &record.text, &record.object}) {
                csv.line().push_back(',');
                put_text(csv.line(), *text);
            }
            const SurfacePlace& at = record.place[i];
            const Vec3f& where = record.position[i];
            fmt::format_to(std::back_inserter(csv.line()), ",{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}",
                           at.triangle, at.u, at.v, at.height, where.x(), where.y(), where.z());
            csv.end_line();
        }
    }
    csv.close();
    return true;
}

}  // namespace

std::vector<std::filesystem::path> export_csv(
    const std::filesystem::path& session, const std::filesystem::path& folder,
    const std::function<void(const std::filesystem::path&)>& progress, const std::function<bool()>& stop) {
    const session::SessionReader reader(session);
    OutputFolder output(folder);
    std::vector<std::filesystem::path>& written = output.written;
    const auto table = [&](const std::string& group, const std::string& name, bool lines) {
        const auto all = reader.series(group);
        std::vector<const Series*> columns;
        for (const Series& series : all) {
            // Series of lines go into a separate table.
            if (is_time(series) || (series.row_shape.size() > 1) == lines) {
                columns.push_back(&series);
            }
        }
        const std::filesystem::path path = folder / (name + ".csv");
        progress(path);
        if (!write_table(path, group, columns, stop)) {
            return false;
        }
        written.push_back(path);
        return true;
    };
    const auto own = [&](const char* name, const auto& write) {
        const std::filesystem::path path = folder / name;
        progress(path);
        if (!write(path, reader, stop)) {
            return false;
        }
        written.push_back(path);
        return true;
    };
    (void)(table("inputs", "inputs", false) && table("inputs/commands", "commands", false) &&
           table("tools", "tools", false) && table("tools", "tube_nodes", true) &&
           (!reader.root().has("contacts") ||
            (table("contacts", "contacts", false) && table("contacts", "contact_forces", true))) &&
           table("skeleton", "skeleton", false) && table("tissue", "tissue", false) &&
           (!reader.root().has("tissue/landmarks") || table("tissue", "landmarks", true)) &&
           table("metrics", "metrics", false) &&
           (!reader.root().has("state") || table("state", "state", false)) &&
           own("deformation.csv", write_deformation) &&
           (!reader.root().has("fluid") || own("fluid.csv", write_fluid)) &&
           table("events", "events", false) && own("annotations.csv", write_annotations) &&
           table("summary", "summary", false) &&
           (!reader.root().has(session::ratings_group) || table(session::ratings_group, "ratings", false)) &&
           (!reader.root().has(session::answers_group) || table(session::answers_group, "answers", false)));
    return output.keep();
}

}  // namespace eti::review
