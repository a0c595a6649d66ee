// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
#include "common/bus/guard/rtps_message.hpp"

#include <algorithm>
#include <optional>

#include "common/bus/guard/security_message.hpp"

namespace eti::bus {

namespace {

constexpr std::size_t header_size = 20, submessage_header_size = 4;

// DDSI-RTPS 2.5, 9.4.5.1.1, and the library's own kinds.
enum Kind : std::uint8_t {
    pad = 0x01,
    acknack = 0x06,
    heartbeat = 0x07,
    gap = 0x08,
    info_timestamp = 0x09,
    info_source = 0x0c,
    info_destination = 0x0e,
    nack_fragments = 0x12,
    heartbeat_fragment = 0x13,
    data = 0x15,
    data_fragment = 0x16,
    statistics = 0x80,
};
constexpr std::uint8_t little_endian = 0x01, inline_qos = 0x02, no_timestamp = 0x02;

bool plausible(std::int64_t number) {
    return number >= 1 && number <= max_sequence_number;
}

/// A bitmap of up to 256 sequence numbers from its base: number of bits, then whole words.
bool skip_bitmap(Reader& in) {
    const std::uint32_t bits = in.u32();
    if (bits > 256) {
        return false;
    }
    in.skip(4 * ((bits + 31) / 32));
    return in.whole();
}

/// Parameters up to the sentinel. `is_valid` receives each parameter's identifier and content.
template <class Check>
bool read_parameter_list(Reader& in, const Check& is_valid) {
    constexpr std::uint16_t sentinel = 1;
    while (in.whole()) {
        const std::uint16_t id = in.u16(), length = in.u16();
        if (id == sentinel) {
            return in.whole();
        }
        if (length % 4 != 0 || length > in.left() || !is_valid(id, in.rest().first(length))) {
            return false;
        }
        in.skip(length);
    }
    return false;
}

constexpr std::uint16_t participant_guid = 0x50, key_hash = 0x70, status_info = 0x71;

/// Whether a parameter names another participant than `participant`.
bool names_another(std::uint16_t id, Bytes content, const ParticipantId& participant) {
    return (id == participant_guid || id == key_hash) &&
           (content.size() < participant.size() ||
            !std::ranges::equal(content.first(participant.size()), participant));
}

constexpr std::size_t length_and_identifier = 4;

/// The place of a parameter's identifier.
Bytes identifier_of(Bytes content) {
    return {content.data() - length_and_identifier, 2};
}

/// Notes a locator (9.4.2.10) that leads beyond this machine: neither loopback nor shared memory, nor, where
/// a group is allowed, a multicast address. Malformed ones do, too.
void note_distant(Bytes content, bool little, bool group_allowed, std::vector<DistantLocator>& distant) {
    constexpr std::uint32_t udp_v4 = 1, shared_memory = 16;
    Reader in(content, little);
    const std::uint32_t kind = in.u32();
    in.skip(4 + 12);  // port; an IPv4 address is in the last four octets
    const auto address = in.octets<4>();
    if (!in.whole() || (kind != udp_v4 && kind != shared_memory)) {
        distant.push_back({identifier_of(content), {}});
        return;
    }
    const bool loopback = address[0] == 127, group = (address[0] & 0xf0u) == 0xe0u;
    if (kind == udp_v4 && !loopback && !(group_allowed && group)) {
        distant.push_back({identifier_of(content), address});
    }
}

/// Elements of a size, preceded by their number.
bool is_counted(Bytes content, bool little, std::size_t element_size) {
    Reader in(content, little);
    const std::uint32_t count = in.u32();
    return in.whole() && count <= in.left() / element_size;
}

/// Names of partitions: strings that end with a zero.
bool is_valid_partition(Bytes content, bool little) {
    Reader in(content, little);
    std::uint32_t names = in.u32();
    for (; names > 0 && in.whole(); --names) {
        const std::uint32_t length = in.u32();
        if (length == 0 || length > in.left() || in.rest()[length - 1] != 0) {
            return false;
        }
        in.skip(length);
        if (in.left() > 0) {
            in.align();
        }
    }
    return in.whole();
}

/// Discovery data. The library allocates as many elements as a token or a type description counts, before it
/// reads them; it reads as many data representations, domains and partitions as are counted, whether they are
/// there or not.
bool is_valid_announcement(Reader& in, bool little, WriterSubmessage& written) {
    constexpr std::uint16_t type_identifier = 0x69, type_object = 0x72, type_information = 0x75;
    constexpr std::uint16_t identity_token = 0x1001, permissions_token = 0x1002;
    constexpr std::uint16_t partition = 0x29, data_representation = 0x73, data_sharing = 0x8006;
    constexpr std::uint16_t unicast = 0x2f, default_unicast = 0x31, metatraffic_unicast = 0x32;
    constexpr std::uint16_t multicast = 0x30, metatraffic_multicast = 0x33, default_multicast = 0x48;
    return read_parameter_list(in, [&](std::uint16_t id, Bytes content) {
        if (written.announcement && names_another(id, content, written.writer.participant)) {
            written.announcement->of_another = true;
        }
        if (id == type_identifier || id == type_object || id == type_information) {
            written.replacements.push_back({identifier_of(content), {0, 0}});  // PID_PAD
        }
        const bool to_one = id == unicast || id == default_unicast || id == metatraffic_unicast;
        const bool to_group = id == multicast || id == metatraffic_multicast || id == default_multicast;
        if (to_one || to_group) {
            note_distant(content, little, to_group, written.distant_locators);
        }
        switch (id) {
            case identity_token:
            case permissions_token:
                return is_valid_token(content, little);
            case partition:
                return is_valid_partition(content, little);
            case data_representation:
                return is_counted(content, little, 2);
            case data_sharing:
                return is_counted(content, little, 8);
            default:
                return true;
        }
    });
}

/// The part that data and fragments share, up to the payload. `fixed`: size of what precedes the inline QoS.
bool skip_to_payload(Reader& in, std::uint8_t flags, std::uint16_t to_inline, std::size_t fixed,
                     WriterSubmessage& written) {
    // Later minor versions of the protocol may insert more; this library miscounts lengths below `fixed`.
    if (to_inline < fixed || to_inline % 4 != 0) {
        return false;
    }
    in.skip(to_inline - fixed);
    return (flags & inline_qos) == 0 || read_parameter_list(in, [&](std::uint16_t id, Bytes content) {
               if (written.announcement) {
                   // Disposed or unregistered.
                   const bool leaves = id == status_info && content.size() >= 4 && (content[3] & 3) != 0;
                   const bool other = names_another(id, content, written.writer.participant);
                   written.announcement->goodbye = written.announcement->goodbye || leaves;
                   written.announcement->of_another = written.announcement->of_another || other;
               }
               return true;
           });
}

/// Whether these entities exchange discovery data (parameter lists) about participants or endpoints.
/// Liveliness is not such data.
bool is_discovery(const std::array<std::uint8_t, 4>& reader, const std::array<std::uint8_t, 4>& writer) {
    const auto announces = [](const std::array<std::uint8_t, 4>& entity, std::uint8_t builtin) {
        return entity[3] == builtin && entity[1] != 0x02;
    };
    return announces(writer, 0xc2) || announces(reader, 0xc7);
}

bool is_valid_data(Reader& in, std::uint8_t flags, WriterSubmessage& written) {
    constexpr std::uint8_t with_data = 0x04, with_key = 0x08;
    in.skip(2);
    const std::uint16_t to_inline = in.u16();
    const auto reader = in.octets<4>();
    written.writer.entity = in.octets<4>();
    constexpr std::array<std::uint8_t, 4> spdp_writer = {0, 1, 0, 0xc2}, spdp_reader = {0, 1, 0, 0xc7};
    if (written.writer.entity == spdp_writer || reader == spdp_reader) {
        written.announcement = Announcement{.content = {}, .goodbye = (flags & with_data) == 0};
    }
    written.whole_sample = in.sequence_number();
    if (!plausible(written.whole_sample) || !skip_to_payload(in, flags, to_inline, 16, written)) {
        return false;
    }
    if ((flags & (with_data | with_key)) == 0) {
        return in.whole();
    }
    // Encapsulation and options.
    if (in.left() < 4) {
        return false;
    }
    if (written.writer.entity == stateless_message_writer) {
        return (flags & with_data) != 0 && is_valid_stateless_message(in.rest());
    }
    if (!is_discovery(reader, written.writer.entity) || (flags & with_data) == 0) {
        return true;
    }
    const auto encapsulation = in.octets<4>();
    const bool big = encapsulation[1] == 0x02, little = encapsulation[1] == 0x03;
    if (encapsulation[0] != 0 || (!big && !little)) {
        return false;
    }
    Reader parameters(in.rest(), little);
    if (written.announcement) {
        written.announcement->content = in.rest();
    }
    return is_valid_announcement(parameters, little, written);
}

bool is_valid_fragments(Reader& in, std::uint8_t flags, WriterSubmessage& written) {
    constexpr std::uint8_t with_key = 0x04, not_standard = 0x08;
    in.skip(2);
    const std::uint16_t to_inline = in.u16();
    in.skip(4);  // reader
    written.writer.entity = in.octets<4>();
    const std::int64_t number = in.sequence_number();
    const std::uint32_t first = in.u32();
    const std::uint16_t count = in.u16(), size = in.u16();
    const std::uint32_t whole = in.u32();
    // The library copies the key's fragments from a null pointer, and writes numbers at every multiple of
    // four bytes in the sample that follows the start of a missing fragment.
    if ((flags & (with_key | not_standard)) != 0 || !plausible(number) || first == 0 || count == 0 ||
        size < min_fragment_bytes || size % 4 != 0 || whole == 0 || whole > max_sample_bytes) {
        return false;
    }
    // The library copies as many bytes as the fragment numbers imply.
    const std::uint64_t from = std::uint64_t{first - 1} * size;
    const std::uint64_t to = std::min<std::uint64_t>(from + std::uint64_t{count} * size, whole);
    if (from >= whole || first - 1 + std::uint64_t{count} > (std::uint64_t{whole} + size - 1) / size ||
        !skip_to_payload(in, flags, to_inline, 28, written) || in.left() < to - from) {
        return false;
    }
    written.fragments = Fragments{number, first, count, size, whole, in.rest().first(to - from)};
    return true;
}

bool is_valid_heartbeat(Reader& in, WriterSubmessage& written) {
    in.skip(4);  // reader
    written.writer.entity = in.octets<4>();
    const std::int64_t first = in.sequence_number(), last = in.sequence_number();
    (void)in.u32();
    written.up_to = last;
    return in.whole() && plausible(first) && last >= first - 1 && last - first < max_sequence_range;
}

/// Bytes of a sequence number.
std::vector<std::uint8_t> sequence_number_bytes(std::int64_t number, bool little) {
    std::vector<std::uint8_t> out;
    for (const auto word : {static_cast<std::uint32_t>(number >> 32), static_cast<std::uint32_t>(number)}) {
        for (unsigned i = 0; i < 4; ++i) {
            out.push_back(static_cast<std::uint8_t>(word >> 8 * (little ? i : 3 - i)));
        }
    }
    return out;
}

/// Cuts off the bitmap of a gap at the first number that it does not name; those before it become part of the
/// range. StatefulReader::processGapMsg forgets fragments of samples in the range only.
void cut_off_bitmap(Bytes base_and_bitmap, std::int64_t base, bool little, WriterSubmessage& written) {
    constexpr std::size_t number_size = 8, count_size = 4;
    Reader in(base_and_bitmap.subspan(number_size), little);
    const std::uint32_t bits = in.u32();
    std::uint32_t word = 0, run = 0, named = 0;
    for (std::uint32_t i = 0; i < bits; ++i) {
        word = i % 32 == 0 ? in.u32() : word;
        const bool is_named = (word >> (31 - i % 32) & 1) != 0;
        named += is_named ? 1 : 0;
        run += is_named && run == i ? 1 : 0;
    }
    if (named > 0) {
        const Bytes words = base_and_bitmap.subspan(number_size + count_size, 4 * ((bits + 31) / 32));
        written.replacements.push_back(
            {base_and_bitmap.first(number_size), sequence_number_bytes(base + run, little)});
        written.replacements.push_back({words, std::vector<std::uint8_t>(words.size())});
    }
}

bool is_valid_gap(Reader& in, bool little, WriterSubmessage& written) {
    in.skip(4);  // reader
    written.writer.entity = in.octets<4>();
    const std::int64_t start = in.sequence_number();
    const Bytes base_and_bitmap = in.rest();
    const std::int64_t base = in.sequence_number();
    written.up_to = base;
    if (!plausible(start) || !plausible(base) || base < start || base - start > max_sequence_range ||
        !skip_bitmap(in)) {
        return false;
    }
    cut_off_bitmap(base_and_bitmap, base, little, written);
    return true;
}

bool is_valid_acknack(Reader& in) {
    in.skip(8);  // reader, writer
    const std::int64_t base = in.sequence_number();
    if (base < 0 || base > max_sequence_number || !skip_bitmap(in)) {
        return false;
    }
    (void)in.u32();
    return in.whole();
}

bool is_valid_nack_fragments(Reader& in) {
    in.skip(8);  // reader, writer
    const std::int64_t number = in.sequence_number();
    const std::uint32_t base = in.u32();
    if (!plausible(number) || base == 0 || base > max_sample_bytes || !skip_bitmap(in)) {
        return false;
    }
    (void)in.u32();
    return in.whole();
}

bool is_valid_heartbeat_fragment(Reader& in, WriterSubmessage& written) {
    in.skip(4);  // reader
    written.writer.entity = in.octets<4>();
    const std::int64_t number = in.sequence_number();
    const std::uint32_t last = in.u32();
    (void)in.u32();
    return in.whole() && plausible(number) && last >= 1 && last <= max_sample_bytes;
}

/// Whether a submessage's content is valid for its kind. `written`: receives the submessages that a writer of
/// `participant` sends.
bool is_valid(std::uint8_t kind, std::uint8_t flags, Bytes content, const ParticipantId& participant,
              std::optional<WriterSubmessage>& written) {
    Reader in(content, (flags & little_endian) != 0);
    WriterSubmessage from;
    from.writer.participant = participant;
    const auto of_writer = [&](bool is_sound) {
        written = from;
        return is_sound;
    };
    switch (kind) {
        case data:
            return of_writer(is_valid_data(in, flags, from));
        case data_fragment:
            return of_writer(is_valid_fragments(in, flags, from));
        case heartbeat:
            return of_writer(is_valid_heartbeat(in, from));
        case heartbeat_fragment:
            return of_writer(is_valid_heartbeat_fragment(in, from));
        case gap:
            return of_writer(is_valid_gap(in, (flags & little_endian) != 0, from));
        case acknack:
            return is_valid_acknack(in);
        case nack_fragments:
            return is_valid_nack_fragments(in);
        case info_timestamp:
            return (flags & no_timestamp) != 0 || content.size() >= 8;
        case info_destination:
            return content.size() >= 12;
        // Changes the source participant of later submessages, which nothing in a session does.
        case info_source:
            return false;
        default:
            return true;  // the library skips unknown kinds
    }
}

}  // namespace

bool is_well_formed(Bytes datagram, const std::function<bool(const WriterSubmessage&)>& refused) {
    constexpr std::array<std::uint8_t, 4> magic = {'R', 'T', 'P', 'S'};
    // The library reads the first submessage's kind from a header alone, too, behind the datagram's end.
    if (datagram.size() <= header_size || !std::ranges::equal(datagram.first(4), magic) || datagram[4] != 2) {
        return false;
    }
    ParticipantId participant{};
    std::ranges::copy(datagram.subspan(8, 12), participant.begin());
    std::size_t at = header_size;
    while (at < datagram.size()) {
        if (datagram.size() - at < submessage_header_size) {
            return false;
        }
        const std::uint8_t kind = datagram[at], flags = datagram[at + 1];
        const std::size_t left = datagram.size() - at - submessage_header_size;
        std::size_t length = (flags & little_endian) != 0
                                 ? static_cast<std::size_t>(datagram[at + 2] | datagram[at + 3] << 8)
                                 : static_cast<std::size_t>(datagram[at + 2] << 8 | datagram[at + 3]);
        if (kind == statistics) {
            constexpr std::size_t content = 56;  // the library asserts this
            return length == content && left == content;
        }
        // Length zero: the rest of the datagram, except for kinds that may be empty.
        if (length == 0 && kind != pad && kind != info_timestamp) {
            length = left;
        }
        if (length > left || (length % 4 != 0 && length != left)) {
            return false;
        }
        std::optional<WriterSubmessage> written;
        if (!is_valid(kind, flags, datagram.subspan(at + submessage_header_size, length), participant,
                      written) ||
            (written && refused && refused(*written))) {
            return false;
        }
        at += submessage_header_size + length;
    }
    return true;
}

}  // namespace eti::bus
