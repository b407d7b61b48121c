// PLY, the Stanford polygon format: a text header that declares elements and their properties, then their values as
// text or binary in either byte order. Of all elements, the vertices (x, y, z), the faces (vertex_indices) and the
// triangle strips (tristrips, whose vertex_indices are several strips with -1 between them) count.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "voml/assets/mesh_readers.h"

namespace dmvv::voml {

namespace {

enum class Encoding : std::uint8_t { text, little_endian, big_endian };
enum class Kind : std::uint8_t { signed_integer, unsigned_integer, floating };

struct Scalar {
  Kind kind = Kind::floating;
  std::uint8_t bytes = 4;
};

struct Property {
  std::string_view name;
  Scalar type;
  std::optional<Scalar> list_count;  ///< the type of a list's length; none: a single value
};

/// Where a declaration stands in the header.
struct Place {
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct Element {
  std::string_view name;
  std::uint64_t count = 0;
  Place place;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  Place end;              ///< of 'end_header'
  std::size_t bytes = 0;  ///< the data begin here
};

[[noreturn]] void refuse_header(const Place& place, std::string message) {
  throw MeshFault{Code::mesh_syntax, place.begin, place.end, std::move(message)};
}

// ---- header ----

class HeaderReader {
 public:
  explicit HeaderReader(std::string_view bytes) : bytes_(bytes), text_(bytes) {}

  Header read() {
    if (text_.rest_of_line() != "ply") text_.refuse_token(Code::mesh_syntax, "a PLY file begins with the line 'ply'");
    const std::string_view behind = bytes_.substr(text_.position());
    const bool lines_end_with_cr = behind.starts_with('\r') && !behind.starts_with("\r\n");
    bool has_format = false;
    for (;;) {
      text_.next_line();
      if (text_.at_end()) text_.refuse_here(Code::mesh_truncated, "the file ends before the header's 'end_header'");
      if (text_.at_line_end()) continue;
      const std::string_view keyword = text_.token();
      if (keyword == "end_header") break;
      if (keyword == "format") {
        read_format();
        has_format = true;
      } else if (keyword == "element") {
        read_element();
      } else if (keyword == "property") {
        read_property();
      } else if (keyword != "comment" && keyword != "obj_info") {
        text_.refuse_token(Code::mesh_syntax,
                           "expected 'format', 'element', 'property', 'comment', 'obj_info' or 'end_header'");
      }
    }
    header_.end = {text_.token_begin(), text_.position()};
    if (!has_format) refuse_header(header_.end, "the header has no 'format' line");
    text_.rest_of_line();
    const std::size_t end_of_line = text_.position();
    text_.next_line();
    // A line feed behind the last CR of a header with such line ends is the first byte of binary data.
    header_.bytes = lines_end_with_cr ? std::min(end_of_line + 1, bytes_.size()) : text_.position();
    return std::move(header_);
  }

 private:
  void read_format() {
    const std::string_view name = text_.token();
    if (name == "ascii") {
      header_.encoding = Encoding::text;
    } else if (name == "binary_little_endian") {
      header_.encoding = Encoding::little_endian;
    } else if (name == "binary_big_endian") {
      header_.encoding = Encoding::big_endian;
    } else {
      text_.refuse_token(Code::mesh_syntax, "expected 'ascii', 'binary_little_endian' or 'binary_big_endian'");
    }
    if (text_.token() != "1.0") text_.refuse_token(Code::mesh_syntax, "expected the version of the format, 1.0");
  }

  void read_element() {
    Element element;
    element.name = text_.token();
    element.place.begin = text_.token_begin();
    if (element.name.empty()) text_.refuse_here(Code::mesh_syntax, "expected the element's name");
    const std::int64_t count = text_.integer("the element's count");
    if (count < 0) text_.refuse_token(Code::mesh_syntax, fmt::format("an element's count is {}", count));
    element.count = static_cast<std::uint64_t>(count);
    element.place.end = text_.position();
    header_.elements.push_back(std::move(element));
  }

  void read_property() {
    if (header_.elements.empty()) text_.refuse_token(Code::mesh_syntax, "a property stands before the first element");
    Property property;
    std::string_view type = text_.token();
    if (type == "list") {
      property.list_count = scalar(text_.token());
      if (property.list_count->kind == Kind::floating) {
        text_.refuse_token(Code::mesh_syntax, "the length of a list has an integer type");
      }
      type = text_.token();
    }
    property.type = scalar(type);
    property.name = text_.token();
    if (property.name.empty()) text_.refuse_here(Code::mesh_syntax, "expected the property's name");
    header_.elements.back().properties.push_back(property);
  }

  Scalar scalar(std::string_view name) const {
    struct Named {
      std::string_view name, other_name;
      Scalar type;
    };
    static constexpr std::array<Named, 8> types{{{"char", "int8", {Kind::signed_integer, 1}},
                                                 {"uchar", "uint8", {Kind::unsigned_integer, 1}},
                                                 {"short", "int16", {Kind::signed_integer, 2}},
                                                 {"ushort", "uint16", {Kind::unsigned_integer, 2}},
                                                 {"int", "int32", {Kind::signed_integer, 4}},
                                                 {"uint", "uint32", {Kind::unsigned_integer, 4}},
                                                 {"float", "float32", {Kind::floating, 4}},
                                                 {"double", "float64", {Kind::floating, 8}}}};
    for (const Named& type : types) {
      if (name == type.name || name == type.other_name) return type.type;
    }
    text_.refuse_token(Code::mesh_syntax,
                       "expected a type: char, uchar, short, ushort, int, uint, float, double, int8 .. float64");
  }

  std::string_view bytes_;
  TextCursor text_;
  Header header_;
};

// ---- values: text and binary behind the same four functions ----

class TextValues {
 public:
  TextValues(std::string_view bytes, std::size_t begin) : text_(bytes) {
    while (text_.position() < begin) text_.next_line();
  }

  static std::uint64_t smallest_bytes(Scalar) { return 2; }          // a digit and a blank
  std::uint64_t remaining() const { return text_.remaining() + 1; }  // the last value needs no blank behind it

  double number(Scalar) {
    text_.skip_space();
    return text_.number("a number");
  }
  std::int64_t integer(Scalar) {
    text_.skip_space();
    return text_.integer("an integer");
  }
  void skip(Scalar, std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      text_.skip_space();
      if (text_.token().empty()) text_.refuse_here(Code::mesh_truncated, "the file ends within its data");
    }
  }
  void expect_end(MeshWarnings& warnings) {
    text_.skip_space();
    if (text_.at_end()) return;
    text_.token();
    warnings.push_back(text_.remark(Code::mesh_trailing_data,
                                    "data behind the last element that the header declares are passed over"));
  }
  /// Refuses the value read last.
  [[noreturn]] void refuse(Code code, std::string message) const { text_.refuse_token(code, std::move(message)); }

 private:
  TextCursor text_;
};

class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, std::size_t begin, bool big_endian)
      : bytes_(bytes), position_(begin), last_(begin), big_endian_(big_endian) {}

  static std::uint64_t smallest_bytes(Scalar type) { return type.bytes; }
  std::uint64_t remaining() const { return bytes_.size() - position_; }

  double number(Scalar type) {
    if (type.kind != Kind::floating) return static_cast<double>(integer(type));
    const std::uint64_t word = next(type.bytes);
    const double value =
        type.bytes == 8 ? std::bit_cast<double>(word) : std::bit_cast<float>(static_cast<std::uint32_t>(word));
    if (!std::isfinite(value)) refuse(Code::mesh_number_not_finite, fmt::format("a coordinate is {}", value));
    return value;
  }
  std::int64_t integer(Scalar type) {
    const std::uint64_t word = next(type.bytes);
    if (type.kind == Kind::unsigned_integer) return static_cast<std::int64_t>(word);
    const int unused_bits = 64 - 8 * type.bytes;
    return static_cast<std::int64_t>(word << unused_bits) >> unused_bits;
  }
  void skip(Scalar type, std::uint64_t count) {
    last_ = position_;
    if (count > remaining() / type.bytes) refuse_end();
    position_ += count * type.bytes;
  }
  void expect_end(MeshWarnings& warnings) const {
    if (remaining() == 0) return;
    warnings.push_back(
        {Code::mesh_trailing_data, position_, position_,
         fmt::format("{} bytes behind the last element that the header declares are passed over", remaining()),
         /*in_text=*/false});
  }
  /// Refuses the value read last.
  [[noreturn]] void refuse(Code code, std::string message) const {
    throw MeshFault{code, last_, last_, std::move(message), /*in_text=*/false};
  }

 private:
  std::uint64_t next(std::size_t size) {
    last_ = position_;
    if (size > remaining()) refuse_end();
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t at = big_endian_ ? i : size - 1 - i;
      word = word << 8 | static_cast<unsigned char>(bytes_[position_ + at]);
    }
    position_ += size;
    return word;
  }
  [[noreturn]] void refuse_end() const { refuse(Code::mesh_truncated, "the file ends within its data"); }

  std::string_view bytes_;
  std::size_t position_;
  std::size_t last_;  ///< where the value read last began
  bool big_endian_;
};

// ---- elements ----

template <class Values>
class ElementReader {
 public:
  ElementReader(const Header& header, Values values) : header_(header), values_(std::move(values)) {
    for (const Element& element : header.elements) {
      if (element.name == "vertex") vertex_count_ = element.count;
    }
  }

  Mesh read(MeshWarnings& warnings) {
    for (const Element& element : header_.elements) {
      check_length(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_lists(element, [&](const Property& property) { read_polygon(property); });
      } else if (element.name == "tristrips") {
        read_lists(element, [&](const Property& property) { read_strips(property); });
      } else {
        skip(element);
      }
    }
    values_.expect_end(warnings);
    return std::move(mesh_);
  }

 private:
  /// Refuses a count that the rest of the file cannot hold, before anything is allocated for it.
  void check_length(const Element& element) const {
    std::uint64_t smallest = 0;
    for (const Property& property : element.properties) {
      smallest += Values::smallest_bytes(property.list_count.value_or(property.type));
    }
    if (smallest == 0 || element.count <= values_.remaining() / smallest) return;
    throw MeshFault{
        Code::mesh_truncated, element.place.begin, element.place.end,
        fmt::format("the header promises {} elements '{}' of at least {} bytes each; {} bytes are left for them",
                    element.count, element.name, smallest, values_.remaining())};
  }

  static std::optional<std::size_t> find(const Element& element, std::string_view name) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (element.properties[i].name == name) return i;
    }
    return std::nullopt;
  }

  void skip(const Property& property) { values_.skip(property.type, property.list_count ? list_length(property) : 1); }

  void skip(const Element& element) {
    if (element.properties.empty()) return;
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (const Property& property : element.properties) skip(property);
    }
  }

  std::uint64_t list_length(const Property& property) {
    const std::int64_t length = values_.integer(*property.list_count);
    if (length < 0) values_.refuse(Code::mesh_syntax, fmt::format("a list has the length {}", length));
    return static_cast<std::uint64_t>(length);
  }

  void read_vertices(const Element& element) {
    constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
    std::vector<int> axis_of(element.properties.size(), -1);
    for (int axis = 0; axis < 3; ++axis) {
      const auto index = find(element, names[axis]);
      if (!index || element.properties[*index].list_count) {
        refuse_header(element.place, fmt::format("the element 'vertex' has no single property '{}'", names[axis]));
      }
      axis_of[*index] = axis;
    }
    mesh_.positions.reserve(mesh_.positions.size() + element.count);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      glm::dvec3 p;
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        if (axis_of[k] < 0) {
          skip(element.properties[k]);
        } else {
          p[axis_of[k]] = values_.number(element.properties[k].type);
        }
      }
      mesh_.positions.push_back(p);
    }
  }

  /// Calls read(property) where the corners of a face or strip stand.
  template <class ReadCorners>
  void read_lists(const Element& element, ReadCorners read_corners) {
    auto indices = find(element, "vertex_indices");
    if (!indices) indices = find(element, "vertex_index");
    if (!indices || !element.properties[*indices].list_count ||
        element.properties[*indices].type.kind == Kind::floating) {
      refuse_header(
          element.place,
          fmt::format("the element '{}' has no list property 'vertex_indices' of an integer type", element.name));
    }
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        if (k == *indices) {
          read_corners(element.properties[k]);
        } else {
          skip(element.properties[k]);
        }
      }
    }
  }

  /// Refuses a list of corners that the rest of the file cannot hold; its length was read last.
  void check_corner_count(std::uint64_t length, const Property& property, std::string_view what) const {
    if (length <= values_.remaining() / Values::smallest_bytes(property.type)) return;
    values_.refuse(Code::mesh_truncated,
                   fmt::format("a {} promises {} corners, {} bytes are left", what, length, values_.remaining()));
  }

  /// A vertex that the file has; it was read last.
  std::uint32_t checked(std::int64_t vertex, std::string_view what) const {
    if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count_) {
      values_.refuse(Code::mesh_index_out_of_range,
                     fmt::format("a {} names vertex {}; the file has {}, counted from 0", what, vertex, vertex_count_));
    }
    return static_cast<std::uint32_t>(vertex);
  }

  void read_polygon(const Property& property) {
    const std::uint64_t length = list_length(property);
    if (length < 3) {
      values_.refuse(Code::mesh_syntax, fmt::format("a face has {} corners, it needs at least 3", length));
    }
    check_corner_count(length, property, "face");
    corners_.clear();
    for (std::uint64_t i = 0; i < length; ++i) corners_.push_back(checked(values_.integer(property.type), "face"));
    append_fan(corners_, mesh_.triangles);
  }

  /// Triangle strips with -1 (of an unsigned type: its greatest value) between them.
  void read_strips(const Property& property) {
    const std::uint64_t length = list_length(property);
    check_corner_count(length, property, "strip");
    const bool is_signed = property.type.kind == Kind::signed_integer;
    const std::int64_t between = is_signed ? -1 : (std::int64_t{1} << 8 * property.type.bytes) - 1;
    corners_.clear();
    for (std::uint64_t i = 0; i < length; ++i) {
      const std::int64_t vertex = values_.integer(property.type);
      if (vertex != between && vertex != -1) {
        corners_.push_back(checked(vertex, "strip"));
        continue;
      }
      append_strip(corners_, mesh_.triangles);
      corners_.clear();
    }
    append_strip(corners_, mesh_.triangles);
  }

  const Header& header_;
  Values values_;
  std::uint64_t vertex_count_ = 0;
  Mesh mesh_;
  std::vector<std::uint32_t> corners_;
};

void check_elements(const Header& header) {
  const auto count = [&](std::string_view name) { return std::ranges::count(header.elements, name, &Element::name); };
  if (count("vertex") != 1) {
    refuse_header(header.end, fmt::format("the header declares {} elements 'vertex', one is needed", count("vertex")));
  }
  if (count("face") == 0 && count("tristrips") == 0) {
    refuse_header(header.end, "the header declares neither an element 'face' nor an element 'tristrips'");
  }
  for (const std::string_view name : {"face", "tristrips"}) {
    if (count(name) > 1)
      refuse_header(header.end, fmt::format("the header declares {} elements '{}'", count(name), name));
  }
}

}  // namespace

Mesh read_ply(std::string_view bytes, MeshWarnings& warnings) {
  const Header header = HeaderReader(bytes).read();
  check_elements(header);
  if (header.encoding == Encoding::text) return ElementReader(header, TextValues(bytes, header.bytes)).read(warnings);
  const BinaryValues values(bytes, header.bytes, header.encoding == Encoding::big_endian);
  return ElementReader(header, values).read(warnings);
}

}  // namespace dmvv::voml
