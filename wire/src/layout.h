// The lister: visits a description and records its fields as data. The layout hash and the tables
// of docs/protocol.md are made from the list.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "wire/description.h"

namespace wire {

struct LayoutRow {
  std::string path;     // "men[].body.position"
  std::string kind;     // "integer", "fixed", ...
  std::uint64_t bits;   // of one element, max
  std::uint64_t count;  // number of elements, max
  std::string range;    // "0..7", "-2..2 by 2^-16"
  std::string unit;
  std::string meaning;
};
using Layout = std::vector<LayoutRow>;

// FNV-1a over everything except the meanings.
std::uint32_t layout_hash(const Layout& layout);
std::uint64_t max_bits(const Layout& layout);

class Lister {
 public:
  const Layout& layout() const { return rows_; }

  void constant(const Constant& f);
  void layout_hash(const LayoutHash& f);
  template <class T>
  void integer(const Integer& f, const T&) {
    add_integer(f);
  }
  void flag(const Flag& f, bool);
  void fixed(const Fixed& f, double) { add_fixed(f, 1); }
  void vector(const Fixed& f, const std::array<float, 3>&) { add_fixed(f, 3); }
  void wrapped(const Wrapped& f, double);
  void rotation(const Rotation& f, const std::array<float, 4>&);
  template <class T>
  void varint(const Varint& f, const T&) {
    add_varint(f);
  }
  void delta(const Delta& f, std::int64_t);
  void bytes(const Bytes& f, const std::vector<std::byte>&);
  void text(const Text& f, const std::string&);
  void align();
  void checksum(const Checksum& f);

  template <class Body>
  void group(const Group& f, Body body) {
    nest(f.name, 1, body);
  }
  template <class Body>
  void when(const Group& f, bool, Body body) {
    add_condition(f);
    body();
  }
  template <class T, std::size_t n, class Body>
  void array(const Group& f, std::array<T, n>& elements, Body body) {
    add_array(f, n);
    nest(std::string(f.name) + "[]", n, [&] { body(elements[0]); });
  }
  template <class T, class Body>
  void list(const List& f, std::vector<T>&, Body body) {
    add_list(f);
    T element{};
    nest(std::string(f.name) + "[]", f.max, [&] { body(element); });
  }

 private:
  template <class Body>
  void nest(const std::string& name, std::uint64_t count, Body body) {
    const std::string outer = prefix_;
    const std::uint64_t outer_count = count_;
    prefix_ += name + ".";
    count_ *= count;
    body();
    prefix_ = outer;
    count_ = outer_count;
  }
  void add(const char* name, const char* kind, std::uint64_t bits, std::string range,
           const char* unit, const char* meaning);
  void add_integer(const Integer& f);
  void add_fixed(const Fixed& f, int components);
  void add_varint(const Varint& f);
  void add_condition(const Group& f);
  void add_array(const Group& f, std::size_t n);
  void add_list(const List& f);

  Layout rows_;
  std::string prefix_;
  std::uint64_t count_ = 1;
};

// describe(lister, message)
template <class Message, class Describe>
Layout list_layout(Describe describe) {
  Lister lister;
  Message message{};
  describe(lister, message);
  return lister.layout();
}

}  // namespace wire
