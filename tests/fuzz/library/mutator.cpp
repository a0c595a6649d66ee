// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
//
// Mutations that keep an input's structure: datagrams, submessages and parameters with true lengths.
// libFuzzer's own mutations of bytes would break a length nearly every time, and the filter would refuse the
// datagram.
#include <cstring>
#include <random>

#include "datagrams.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace eti::fuzz {

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t header = 20, submessage_header = 4, max_datagram = 9000;

struct Submessage {
    std::uint8_t kind = 0, flags = 0;
    Bytes content;
};

struct Message {
    Bytes header;
    std::vector<Submessage> submessages;
};

Message parsed(const Bytes& datagram) {
    Message out;
    const std::size_t first = std::min(header, datagram.size());
    out.header.assign(datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(first));
    out.header.resize(header);
    for (std::size_t at = first; at + submessage_header <= datagram.size();) {
        Submessage one{datagram[at], datagram[at + 1], {}};
        std::size_t length = (one.flags & 1) != 0 ? datagram[at + 2] | datagram[at + 3] << 8
                                                  : datagram[at + 2] << 8 | datagram[at + 3];
        at += submessage_header;
        const bool may_be_empty = one.kind == 0x01 || one.kind == 0x09;
        length = length == 0 && !may_be_empty ? datagram.size() - at : std::min(length, datagram.size() - at);
        const auto begin = datagram.begin() + static_cast<std::ptrdiff_t>(at);
        one.content.assign(begin, begin + static_cast<std::ptrdiff_t>(length));
        out.submessages.push_back(std::move(one));
        at += length;
    }
    return out;
}

Bytes joined(const Message& message) {
    Bytes out = message.header;
    const char magic[] = {'R', 'T', 'P', 'S', 2};
    std::ranges::copy(magic, out.begin());
    for (const Submessage& one : message.submessages) {
        Bytes content = one.content;
        content.resize((content.size() + 3) / 4 * 4);
        const auto size = static_cast<std::uint16_t>(content.size());
        out.insert(out.end(), {one.kind, one.flags});
        const auto low = static_cast<std::uint8_t>(size), high = static_cast<std::uint8_t>(size >> 8);
        out.push_back((one.flags & 1) != 0 ? low : high);
        out.push_back((one.flags & 1) != 0 ? high : low);
        out.insert(out.end(), content.begin(), content.end());
    }
    return out;
}

class Mutation {
  public:
    explicit Mutation(unsigned seed) : random_(seed) {}

    void apply(Datagrams& input) {
        if (input.empty()) {
            input.push_back({false, joined({Bytes(header), {{0x07, 1, Bytes(28)}}})});
        }
        const std::size_t at = below(input.size());
        switch (below(12)) {
            case 0:
                input.insert(input.begin() + static_cast<std::ptrdiff_t>(below(input.size() + 1)), input[at]);
                break;
            case 1:
                if (input.size() > 1) {
                    input.erase(input.begin() + static_cast<std::ptrdiff_t>(at));
                }
                break;
            case 2:
                std::swap(input[at], input[below(input.size())]);
                break;
            case 3:
                input[at].to_user_port = !input[at].to_user_port;
                break;
            default:
                for (std::size_t times = 1 + below(3); times > 0; --times) {
                    mutate(input[at].bytes, input[below(input.size())].bytes);
                }
        }
    }

    std::size_t below(std::size_t end) { return end == 0 ? 0 : random_() % end; }

  private:
    void mutate(Bytes& datagram, const Bytes& other) {
        Message message = parsed(datagram);
        if (message.submessages.empty()) {
            message.submessages.push_back({0x07, 1, Bytes(28)});
        }
        auto& all = message.submessages;
        const auto at = all.begin() + static_cast<std::ptrdiff_t>(below(all.size()));
        switch (below(10)) {
            case 0:
                all.insert(at, Submessage(*at));
                break;
            case 1:
                if (all.size() > 1) {
                    all.erase(at);
                }
                break;
            case 2:
                if (const Message from = parsed(other); !from.submessages.empty()) {
                    all.insert(at, from.submessages[below(from.submessages.size())]);
                }
                break;
            case 3:
                sender(message.header, other);
                break;
            case 4:
                at->flags = static_cast<std::uint8_t>(at->flags ^ (1u << below(8)));
                break;
            case 5:
                at->kind = any_of({0x01, 0x06, 0x07, 0x08, 0x09, 0x0e, 0x12, 0x13, 0x15, 0x16, 0x30, 0x31,
                                   0x32, 0x33, 0x34});
                break;
            case 6:
                all.insert(at, {0x0e, 1, Bytes(own_prefix.begin(), own_prefix.end())});
                break;
            default:
                content(*at);
        }
        datagram = joined(message);
        datagram.resize(std::min(datagram.size(), max_datagram));
    }

    /// The datagram's sender becomes another one: of the other datagram, of this host, or unknown.
    void sender(Bytes& of, const Bytes& other) {
        const auto prefix = of.begin() + 8;
        switch (below(3)) {
            case 0:
                std::copy_n(other.size() >= header ? other.begin() + 8 : prefix, 12, prefix);
                break;
            case 1:
                std::copy_n(own_prefix.begin(), head_bytes, prefix);
                break;
            default:
                prefix[11] = static_cast<std::uint8_t>(below(4));
        }
    }

    void content(Submessage& of) {
        if (of.content.size() < 8) {
            bytes(of.content);
            return;
        }
        const bool is_data = of.kind == 0x15 && of.content.size() >= 24;
        switch (below(is_data ? 8 : 4)) {
            case 0:
                entity(of.content, of.kind == 0x15 || of.kind == 0x16 ? 4 : 0);
                break;
            case 1:
            case 2:
                number(of.content);
                break;
            case 3:
                bytes(of.content);
                break;
            default:
                parameters(of);
        }
    }

    /// Reader and writer: usual ones.
    void entity(Bytes& content, std::size_t at) {
        static constexpr std::uint8_t known[][4] = {
            {0, 1, 0, 0xc2},    {0, 1, 0, 0xc7},    {0, 0, 3, 0xc2},    {0, 0, 3, 0xc7},   {0, 0, 4, 0xc2},
            {0, 0, 4, 0xc7},    {0, 2, 0, 0xc2},    {0, 2, 0, 0xc7},    {0, 2, 1, 0xc3},   {0, 2, 1, 0xc4},
            {0, 3, 0, 0xc3},    {0, 3, 0, 0xc4},    {0, 0, 0, 0},       {0, 0, 1, 2},      {0, 0, 1, 3},
            {0, 0, 2, 3},       {0, 0, 3, 2},       {0, 0, 1, 7},       {0, 0, 2, 4},      {0, 0, 3, 4},
            {0xff, 0, 3, 0xc2}, {0xff, 0, 4, 0xc7}, {0xff, 2, 2, 0xc3}, {0xff, 2, 2, 0xc4}};
        at += 4 * below(2);
        if (at + 4 <= content.size()) {
            std::ranges::copy(known[below(std::size(known))],
                              content.begin() + static_cast<std::ptrdiff_t>(at));
        }
    }

    /// A number of four bytes at a multiple of four becomes a nearby or an extreme one.
    void number(Bytes& content) {
        const std::size_t at = 4 * below(std::min<std::size_t>(content.size(), 64) / 4);
        std::uint32_t value = 0;
        std::memcpy(&value, content.data() + at, 4);
        switch (below(4)) {
            case 0:
                value += static_cast<std::uint32_t>(below(9)) - 4;
                break;
            case 1:
                value = static_cast<std::uint32_t>(below(6));
                break;
            case 2:
                value = std::uint32_t{1} << below(32);
                break;
            default:
                value = static_cast<std::uint32_t>(any_of({0, 1, 0x7f, 0xff})) * 0x01010101u;
        }
        std::memcpy(content.data() + at, &value, 4);
    }

    void bytes(Bytes& content) {
        const std::size_t size = content.size();
        content.resize(size + 64);
        content.resize(LLVMFuzzerMutate(content.data(), size, content.size()));
    }

    /// A parameter of a list is repeated, left out, renamed or changed. The list is that of discovery data or
    /// precedes them.
    void parameters(Submessage& of) {
        const bool inline_list = (of.flags & 2) != 0 && below(2) == 0;
        const std::size_t begin = inline_list ? 20 : 24;
        struct Span {
            std::size_t at, size;
        };
        std::vector<Span> found;
        for (std::size_t at = begin; at + 4 <= of.content.size();) {
            const std::size_t id = of.content[at] | of.content[at + 1] << 8;
            const std::size_t length = of.content[at + 2] | of.content[at + 3] << 8;
            if (id == 1 || at + 4 + length > of.content.size()) {
                break;
            }
            found.push_back({at, 4 + length});
            at += 4 + length;
        }
        if (found.empty()) {
            bytes(of.content);
            return;
        }
        const Span one = found[below(found.size())];
        const auto first = of.content.begin() + static_cast<std::ptrdiff_t>(one.at);
        Bytes parameter(first, first + static_cast<std::ptrdiff_t>(one.size));
        of.content.erase(first, first + static_cast<std::ptrdiff_t>(one.size));
        switch (below(5)) {
            case 0:
                parameter.clear();
                break;
            case 1:
                parameter.insert(parameter.end(), parameter.begin(), parameter.end());
                break;
            case 2:
                parameter[0] = any_of({0x02, 0x04, 0x05, 0x07, 0x0f, 0x15, 0x16, 0x1a, 0x1b, 0x1d,
                                       0x29, 0x2c, 0x2f, 0x30, 0x31, 0x32, 0x33, 0x48, 0x50, 0x52,
                                       0x58, 0x59, 0x5a, 0x62, 0x69, 0x70, 0x71, 0x72, 0x75, 0x77});
                parameter[1] = any_of({0, 0, 0, 0x10, 0x80});
                break;
            default: {
                Bytes content(parameter.begin() + 4, parameter.end());
                below(2) == 0 && content.size() >= 4 ? number(content) : bytes(content);
                content.resize((content.size() + 3) / 4 * 4);
                parameter.resize(4);
                parameter.insert(parameter.end(), content.begin(), content.end());
                parameter[2] = static_cast<std::uint8_t>(content.size());
                parameter[3] = static_cast<std::uint8_t>(content.size() >> 8);
            }
        }
        const Span place = found[below(found.size())];
        const std::size_t to = std::min(place.at, of.content.size());
        of.content.insert(of.content.begin() + static_cast<std::ptrdiff_t>(place.at <= one.at ? to : one.at),
                          parameter.begin(), parameter.end());
    }

    std::uint8_t any_of(std::initializer_list<std::uint8_t> values) {
        return values.begin()[below(values.size())];
    }

    std::minstd_rand random_;
};

std::size_t stored(const Datagrams& datagrams, std::uint8_t* data, std::size_t max_size) {
    const Bytes out = input_of(datagrams);
    const std::size_t size = std::min(out.size(), max_size);
    std::copy_n(out.begin(), size, data);
    return size;
}

}  // namespace

}  // namespace eti::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    using namespace eti::fuzz;
    Mutation mutation(seed);
    if (mutation.below(20) == 0) {
        return LLVMFuzzerMutate(data, size, max_size);
    }
    Datagrams input = parse({data, size});
    for (std::size_t times = 1 + mutation.below(4); times > 0; --times) {
        mutation.apply(input);
    }
    return stored(input, data, max_size);
}

extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* one, std::size_t one_size,
                                                 const std::uint8_t* other, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t max_size, unsigned seed) {
    using namespace eti::fuzz;
    Mutation mutation(seed);
    Datagrams first = parse({one, one_size});
    const Datagrams second = parse({other, other_size});
    first.resize(mutation.below(first.size() + 1));
    for (const Datagram& datagram : second) {
        if (mutation.below(2) == 0) {
            const auto at = static_cast<std::ptrdiff_t>(mutation.below(first.size() + 1));
            first.insert(first.begin() + at, datagram);
        }
    }
    return stored(first, out, max_size);
}
