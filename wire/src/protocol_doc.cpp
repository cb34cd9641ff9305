#include "protocol_doc.h"

#include <flatbuffers/reflection_generated.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>
#include <vector>

#include "layouts.h"
#include "wire/control.h"
#include "wire/device_frame.h"
#include "wire/input_datagram.h"
#include "wire/journal.h"
#include "wire/phone_message.h"
#include "wire/seal.h"
#include "wire/snapshot.h"

namespace wire {
namespace {

constexpr const char* kHead = R"(# The protocol

<!-- Made by wire_protocol_doc from wire/include/wire/*_description.h, wire/control.fbs and
     wire/include/wire/device_frame.h, device_command.h and device_settings.h. Do not edit: change those, then run
     `ninja -C build/release wire_protocol_doc && build/release/bin/wire_protocol_doc docs/protocol.md`. -->

Processes exchange six kinds of data: snapshots and input datagrams over UDP, control messages over
TCP, messages of phones over a WebSocket, the journal in a file, and the cabinet's frames, commands and
settings over USB. Everything is little endian.
)";

constexpr const char* kVocabulary = R"(
## Encoding of the bit-packed messages

Snapshot, input datagram and journal payloads are fields without gaps, in the order of their tables.
Bits are filled from the lowest of each byte, bytes in order. `x[]` is an element of an array or list;
"max bits" is the maximum size of one field, "times" its maximum number of occurrences.

| kind | written as |
|---|---|
| constant | always this value; anything else is rejected |
| hash | 32 bits, the layout hash given with the table: FNV-1a over names, kinds, bits and ranges. A message with another hash is of another version and is rejected |
| integer, flag | unsigned; a value above the range is rejected |
| fixed | value = step * (code - zero), where zero = 2^(bits-1) - 1; a code of all ones is rejected. "x3": three of them, x, y, z |
| unsigned fixed | value = step * code |
| wrapped | an angle in units of 1/65536 turn as two's complement: angles that differ by 2^bits units have the same code |
| rotation | 2 bits: which of x, y, z, w is the largest; then the three others in order, each as a fixed of 15 bits over +-1/sqrt(2). The largest is sqrt(1 - sum of squares). Rejected if it is smaller than another one by more than 3 steps |
| varint | groups of 7 bits, lowest first, each in 8 bits; the highest bit is 1 if more follow; the shortest form only |
| delta | a signed number v as the varint of (v << 1) xor (v >> 63) |
| array | the given number of elements, with nothing before them |
| list | the number of elements, in "max bits", then the elements |
| condition | no bits; the following fields of its structure exist only if the flag before is 1 |
| bytes | the length as a varint, zero bits to the next byte, then the bytes |
| text | as bytes: UTF-8 without control characters |
| padding | zero bits to the next byte |
| checksum | CRC-32 as in zlib (reflected 0x04C11DB7) over all bytes before it; nothing may follow |

A sender clamps values that are out of range, and writes 0 for values that are not finite. A receiver
rejects a complete message for a wrong magic, version, layout hash or checksum, a value out of range, or
a wrong length.
)";

constexpr const char* kControlText = R"(
A stream of messages both ways, each a u32 length of the rest (1 to %zu; more ends the connection)
and a FlatBuffers buffer of that length with the file identifier "SFCT", root table `Control`, not
size-prefixed. `wire/control.fbs` is the schema. Every buffer is verified before it is read. Texts are
UTF-8 without control characters. A message of an unknown kind, one that fails verification and a value
out of range end the connection.

On the same machine (127.0.0.0/8, ::1) the client begins with Hello. From another machine it begins with
Knock; the server answers with Challenge, both derive keys (docs/decisions/0040-who-may-join.md), and all
that follows in both directions is a sealed stream: frames of a u32 length of the rest (17 to
%zu), bytes encrypted with ChaCha20-Poly1305, and the tag of 16 bytes. The nonce is four zero bytes
and the frame's number from 0 as u64; the length is authenticated with it. The contents of the frames,
concatenated, are the stream of messages above.
)";

constexpr const char* kSealText = R"(
Every datagram on the network is sealed with ChaCha20-Poly1305 (RFC 8439), under a key from the
Welcome: `input_key` for those of the client, `snapshot_key` for those of the server.

| offset | size | field |
|---|---|---|
| 0 | 4 | id of the key: the client's number from Welcome; 0 for a multicast group's |
| 4 | 8 | counter, rises with each datagram of the key |
| 12 | n | the datagram, encrypted |
| 12 + n | 16 | tag |

The nonce is four zero bytes and the counter; the first 12 bytes are authenticated. A receiver accepts
each counter once, and none that is %llu or more behind the newest. It accepts datagrams from the other
side's address and port only. Datagrams are never answered.
)";

constexpr const char* kJournalText = R"(
A file is a sequence of records, appended during play, so that everything written before a power
cut can be read:

| offset | size | field |
|---|---|---|
| 0 | 4 | length of the payload, at least 1 |
| 4 | 4 | CRC-32 of the payload |
| 8 | length | payload, described below by its first byte |

A reader stops at the first bad record and uses all before it. The first record is a header, the last,
if play ended regularly, an end; ticks count up from 0 without a gap. Ticks are stored in records of
up to %d, each tick as the change from the one before; any other entry ends a record early.
)";

constexpr const char* kPhonesText = R"(
A phone opens `ws://HOST:PORT/TOKEN/ws` of the address in the server's Phones message
(`http://HOST:PORT/TOKEN`, which serves the page). Each binary message is one of these; all fields are
whole bytes. A phone sends at most %zu bytes per message and 500 messages a second. A message that is
longer, truncated or out of range, and a text message, end the connection.
)";

template <class... Values>
std::string formatted(const char* format, Values... values) {
  const int size = std::snprintf(nullptr, 0, format, values...);
  std::string text(static_cast<std::size_t>(size) + 1, '\0');
  std::snprintf(text.data(), text.size(), format, values...);
  text.pop_back();
  return text;
}

std::string table(const Layout& layout) {
  std::string text = "| field | kind | max bits | times | range | unit | meaning |\n";
  text += "|---|---|---|---|---|---|---|\n";
  for (const LayoutRow& row : layout) {
    text += "| " + row.path + " | " + row.kind + " | " + std::to_string(row.bits) + " | " +
            std::to_string(row.count) + " | " + row.range + " | " + row.unit + " | " + row.meaning +
            " |\n";
  }
  return text;
}

std::string datagram(const Layout& layout, std::size_t cap) {
  return formatted("\nLayout hash 0x%08X. At most %zu bytes, never more than %zu.\n\n",
                   layout_hash(layout), static_cast<std::size_t>(max_bits(layout) / 8), cap) +
         table(layout);
}

std::string journal() {
  std::string text = formatted(kJournalText, kJournalBatch);
  text += formatted("\nLayout hash 0x%08X, over all these tables.\n", journal_layout_hash());
  for (const NamedLayout& part : journal_layouts()) {
    text += std::string("\n### ") + part.name + "\n\n" + part.meaning + "\n\n" + table(part.layout);
  }
  return text;
}

std::string phones() {
  std::string text = formatted(kPhonesText, kMaxPhoneRequest);
  for (const NamedLayout& part : phone_layouts())
    text += std::string("\n### ") + part.name + "\n\n" + part.meaning + "\n\n" + table(part.layout);
  return text;
}

std::string file_text(const char* path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

using Comments = flatbuffers::Vector<flatbuffers::Offset<flatbuffers::String>>;

std::string comment(const Comments* lines) {
  std::string text;
  if (lines == nullptr) return text;
  for (const auto* line : *lines) text += line->str();
  return text.empty() ? text : text.substr(text.find_first_not_of(' '));
}

// The schema's table or enumeration of that name. (LookupByKey does the same, but g++ 12 reports a
// null pointer in it under the sanitizers.)
template <class List>
const auto& named(const List& list, const std::string& name) {
  return **std::ranges::find_if(
      list, [&](const auto* entry) { return entry->name()->string_view() == "wire.fb." + name; });
}

std::string type_name(const reflection::Schema& schema, const reflection::Field& field) {
  const reflection::Type& type = *field.type();
  if (type.base_type() == reflection::Vector) {
    if (type.element() != reflection::Obj) return "u8[]";
    const auto& name = schema.objects()->Get(static_cast<unsigned>(type.index()))->name()->str();
    return name.substr(name.rfind('.') + 1) + "[]";
  }
  if (type.index() >= 0 && type.base_type() != reflection::Obj) {
    const auto* values = schema.enums()->Get(static_cast<unsigned>(type.index()))->values();
    std::string text;
    for (const auto* value : *values) {
      text +=
          (text.empty() ? "" : ", ") + std::to_string(value->value()) + " " + value->name()->str();
    }
    return "u8: " + text;
  }
  switch (type.base_type()) {
    case reflection::Bool:
      return "bool";
    case reflection::UByte:
      return "u8";
    case reflection::UShort:
      return "u16";
    case reflection::UInt:
      return "u32";
    case reflection::ULong:
      return "u64";
    case reflection::Long:
      return "i64";
    case reflection::Float:
      return "f32";
    case reflection::Double:
      return "f64";
    case reflection::String:
      return "string";
    default:
      return reflection::EnumNameBaseType(type.base_type());
  }
}

std::string control_table(const reflection::Schema& schema, const reflection::Object& object) {
  std::vector<const reflection::Field*> fields(object.fields()->begin(), object.fields()->end());
  std::ranges::sort(fields, {}, [](const reflection::Field* field) { return field->id(); });
  std::string text = "\n| id | field | type | default | meaning |\n|---|---|---|---|---|\n";
  for (const auto* field : fields) {
    const std::string start =
        field->required() ? "required" : std::to_string(field->default_integer());
    text += "| " + std::to_string(field->id()) + " | " + field->name()->str() + " | " +
            type_name(schema, *field) + " | " + start + " | " + comment(field->documentation()) +
            " |\n";
  }
  return text;
}

std::string control() {
  std::string text = formatted(kControlText, kMaxControlMessage, kMaxSealedFrame);
  const std::string binary = file_text(WIRE_CONTROL_BFBS);
  flatbuffers::Verifier verifier(reinterpret_cast<const std::uint8_t*>(binary.data()),
                                 binary.size());
  if (!reflection::VerifySchemaBuffer(verifier)) return "(no schema)\n";
  const reflection::Schema& schema = *reflection::GetSchema(binary.data());
  std::set<std::string> messages;
  for (const auto* value : *named(*schema.enums(), "Message").values()) {
    if (value->value() == 0) continue;  // NONE
    const std::string name = value->name()->str();
    messages.insert(name);
    const auto& object = named(*schema.objects(), name);
    const std::string words = comment(object.documentation());
    text += "\n### " + std::to_string(value->value()) + " " + name + "\n";
    text += (words.empty() ? "" : "\n" + words + "\n") + control_table(schema, object);
  }
  for (const auto* object : *schema.objects()) {
    const std::string full = object->name()->str(), name = full.substr(full.rfind('.') + 1);
    if (messages.contains(name) || object == schema.root_table()) continue;
    text += "\n### " + name + ", within a message\n\n" + comment(object->documentation()) + "\n" +
            control_table(schema, *object);
  }
  text += "\n### The list of Characters\n\n" + table(characters_layout());
  return text;
}

// The header's opening comment: the lines before its include guard.
std::string opening_comment(const char* path) {
  std::istringstream header(file_text(path));
  std::string text = "\n```\n";
  for (std::string line; std::getline(header, line) && line.starts_with("//");) {
    text += line.size() > 3 ? line.substr(3) + "\n" : "\n";
  }
  return text + "```\n";
}

}  // namespace

std::string protocol_document() {
  std::string text = kHead;
  text += kVocabulary;
  text += "\n## Sealed datagrams\n";
  text += formatted(kSealText, static_cast<unsigned long long>(DatagramOpener::kWindow));
  text += "\n## Snapshot\n\nUDP, server to every listener, one per tick.\n";
  text += datagram(snapshot_layout(), kMaxDatagram);
  text +=
      "\n## Input datagram\n\nUDP, client to server, on every change and at least 20 a second.\n";
  text += datagram(input_layout(), kMaxInputDatagram);
  text += "\n## Control messages\n" + control();
  text += "\n## Phones\n" + phones();
  text += "\n## Journal\n" + journal();
  text += "\n## Device frame\n" + opening_comment(WIRE_DEVICE_FRAME_H);
  text += "\n## Device command\n" + opening_comment(WIRE_DEVICE_COMMAND_H);
  text += "\n## Device settings\n" + opening_comment(WIRE_DEVICE_SETTINGS_H);
  return text;
}

}  // namespace wire
