// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// The library behind the filter: a sequence of datagrams, which a participant of ours receives. What the
// filter lets through may neither end the program nor take longer or more memory than stated below. A
// participant receives many inputs in a row, after the introduction of another program; everything it has
// received is in history-PID.rtps, an input that repeats it. With ETI_FUZZ_RECORD=FOLDER the program records
// inputs instead.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <optional>

#include "common/bus/guard/rtps_message.hpp"
#include "common/bus/library_log.hpp"
#include "memory_network.hpp"
#include "recording.hpp"
#include "target.hpp"
#include "tests/fuzz/reader.hpp"

#if defined(__SANITIZE_ADDRESS__)
#define ETI_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ETI_ADDRESS_SANITIZER
#endif
#endif
#ifdef ETI_ADDRESS_SANITIZER
#include <sanitizer/allocator_interface.h>
#else
#include <malloc.h>
#endif

namespace eti::fuzz {

namespace {

// A datagram may cost this much processor time, with sanitizers.
constexpr double max_seconds = 2;
// A participant may hold this much, however many datagrams it has received.
constexpr std::size_t max_growth_bytes = std::size_t{256} << 20;
// Sequence numbers that only the server's first heartbeat may name; the library counts to them one by one.
constexpr std::int64_t left_out = 2 * bus::max_sequence_range;

std::string setting(const char* name, const std::string& unset) {
    const char* const value = std::getenv(name);
    return value != nullptr ? value : unset;
}

double thread_seconds() {
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::size_t allocated_bytes() {
#ifdef ETI_ADDRESS_SANITIZER
    return __sanitizer_get_current_allocated_bytes();
#else
    const auto heap = ::mallinfo2();
    return heap.uordblks + heap.hblkhd;
#endif
}

/// What the participant has received, in a file that survives the process.
class History {
  public:
    History() {
        const int file = ::open(name_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
        require(file >= 0 && ::ftruncate(file, size) == 0, "cannot write " + name_);
        bytes_ =
            static_cast<std::uint8_t*>(::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
        ::close(file);
        require(bytes_ != MAP_FAILED, "cannot map " + name_);
    }
    void remove() const { ::unlink(name_.c_str()); }
    void begin() { at_ = 0; }
    void add(const Datagram& one) {
        std::vector<std::uint8_t> record;
        append(record, one);
        constexpr std::size_t end = 3;
        if (!one.bytes.empty() && at_ + record.size() + end <= size) {
            std::ranges::copy(record, bytes_ + at_);
            at_ += record.size();
            std::memset(bytes_ + at_, 0, end);
        }
    }

  private:
    static constexpr std::size_t size = std::size_t{64} << 20;
    const std::string name_ = fmt::format("history-{}.rtps", ::getpid());
    std::uint8_t* bytes_ = nullptr;
    std::size_t at_ = 0;
};

/// In a last fragment of less than four bytes the library writes up to three behind the sample. Allocations
/// are multiples of eight bytes, so that this harms nothing, and ordinary samples have such an end.
bool has_short_end(const std::optional<bus::Fragments>& fragments) {
    return fragments && fragments->sample % fragments->size > 0 && fragments->sample % fragments->size < 4;
}

class Bench {
  public:
    Bench() {
        bus::bus_log().set_level(spdlog::level::off);
        if (const std::string folder = setting("ETI_FUZZ_RECORD", ""); !folder.empty()) {
            record(folder, lab_);
            std::_Exit(0);
        }
        std::ifstream in(folder_ / "introduction", std::ios::binary);
        const std::vector<char> bytes(std::istreambuf_iterator<char>(in), {});
        introduction_ = parse({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    }
    void report() const {
        history_.remove();
        fmt::print(stderr, "{} datagrams in {} inputs, {} of them well-formed; {} participants\n", datagrams_,
                   inputs_, well_formed_, participants_);
    }

    void run(const Datagrams& input) {
        if (!target_ || inputs_ % inputs_per_participant_ == 0) {
            start();
        }
        ++inputs_;
        for (const Datagram& one : input) {
            receive(one);
        }
        target_->take();
        if (inputs_ % 16 == 0 && allocated_bytes() > before_ + max_growth_bytes) {
            found(fmt::format("the participant holds {} MB more than at its start",
                              (allocated_bytes() - before_) >> 20));
        }
    }

  private:
    void start() {
        target_.reset();
        const bool secured = !lab_.empty();
        target_.emplace("eti-client", secured ? Side::client : Side::both, secured ? lab_ / "hands" : lab_);
        history_.begin();
        ++participants_;
        target_->publish();
        for (const Datagram& one : introduction_) {
            receive(one);
        }
        before_ = allocated_bytes();
    }

    void receive(Datagram one) {
        history_.add(one);
        replace_prefix(one.bytes, own_prefix, target_->prefix());
        ++datagrams_;
        bool skip = false;
        well_formed_ += bus::is_well_formed(one.bytes,
                                            [&](const bus::WriterSubmessage& written) {
                                                skip = skip || written.up_to > left_out ||
                                                       has_short_end(written.fragments);
                                                return false;
                                            })
                            ? 1
                            : 0;
        if (skip) {
            return;
        }
        const double began = thread_seconds();
        target_->receive(one);
        if (const double took = thread_seconds() - began; took > max_seconds) {
            found(fmt::format("one datagram took {:.1f} s", took));
        }
    }

    const std::filesystem::path lab_ = setting("ETI_FUZZ_LAB", "");
    const std::filesystem::path folder_ = setting("ETI_FUZZ_FOLDER", ETI_FUZZ_FOLDER);
    const std::uint64_t inputs_per_participant_ = std::stoull(setting("ETI_FUZZ_INPUTS", "256"));
    History history_;
    Datagrams introduction_;
    std::optional<Target> target_;
    std::size_t before_ = 0;
    std::uint64_t inputs_ = 0, datagrams_ = 0, well_formed_ = 0, participants_ = 0;
};

}  // namespace

}  // namespace eti::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // Never destroyed: the library's own static objects may already be gone.
    static auto* const bench = [] {
        static auto* const made = new eti::fuzz::Bench;
        (void)std::atexit([] { made->report(); });
        return made;
    }();
    bench->run(eti::fuzz::parse({data, size}));
    return 0;
}
