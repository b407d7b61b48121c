#include "compiler/program_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstring>
#include <set>
#include <type_traits>

#include "base/content_hash.h"
#include "compiler/compile.h"
#include "compiler/layout/scene_buffers.h"
#include "compiler/snippet/check_program.h"
#include "shaders/records.h"

namespace dmvv::compiler {

namespace {

constexpr std::string_view mark = "dmvv program\n";
constexpr std::uint32_t format = 2;
constexpr std::size_t hash_digits = 32;
constexpr std::uint32_t most_nested = 256;  // lists within lists of one kind: sequences of a snippet
constexpr std::uint32_t longest_extent = 16384;

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

// ---- the fields of each struct, once for both directions ----

template <class Archive>
void fields(Archive& a, snippet::Constant& x) {
  a(x.type, x.bits);
}
template <class Archive>
void fields(Archive& a, snippet::Array& x) {
  a(x.type, x.size);
}
template <class Archive>
void fields(Archive& a, snippet::Instruction& x) {
  a(x.op, x.result, x.operands[0], x.operands[1], x.operands[2]);
}
template <class Archive>
void fields(Archive& a, snippet::Node& x) {
  a(x.kind, x.first, x.count, x.condition, x.body, x.other);
}
template <class Archive>
void fields(Archive& a, snippet::Program& x) {
  a(x.constants, x.variables, x.temporaries, x.arrays, x.instructions, x.body, x.result);
}
template <class Archive>
void fields(Archive& a, snippet::TimeSlot& x) {
  a(x.result, x.period, x.program);
}
template <class Archive>
void fields(Archive& a, Buffer& x) {
  a(x.name, x.binding, x.bytes, x.count, x.form);
}
template <class Archive>
void fields(Archive& a, Texture& x) {
  a(x.name, x.binding, x.extent.x, x.extent.y, x.extent.z, x.format, x.filtered, x.texels);
}
template <class Archive>
void fields(Archive& a, Shader& x) {
  a(x.glsl, x.spirv, x.has_next);
}
template <class Archive>
void fields(Archive& a, Kernel& x) {
  a.name_of(x.spec);
  a(x.shaders);
}
template <class Archive>
void fields(Archive& a, RegionInfo& x) {
  a(x.number, x.object, x.region, x.kind, x.rgb.x, x.rgb.y, x.rgb.z, x.opacity);
}
template <class Archive>
void fields(Archive& a, ObjectForm& x) {
  a(x.object, x.form);
}
template <class Archive>
void fields(Archive& a, SceneCounts& x) {
  a(x.objects, x.functions, x.sdfs, x.nodes, x.regions, x.candidates, x.seeds, x.depth);
}
template <class Archive>
void fields(Archive& a, ProgramBytes& x) {
  a(x.buffers, x.textures, x.atlas_fill);
}
template <class Archive>
void fields(Archive& a, CodeSize& x) {
  a(x.glsl_lines, x.inlined_lines, x.stages);
}
template <class Archive>
void fields(Archive& a, Sharing& x) {
  a(x.united_objects, x.united_functions, x.seed_chains, x.chained_sdfs, x.listed_objects, x.sunk_objects);
}
template <class Archive>
void fields(Archive& a, Statistics& x) {
  a(x.scene, x.bytes, x.code, x.shared, x.objects, x.tapes);
}
template <class Archive>
void fields(Archive& a, voml::Bounds& x) {
  a(x.lo.x, x.lo.y, x.lo.z, x.hi.x, x.hi.y, x.hi.z);
}
template <class Archive>
void fields(Archive& a, Program& x) {
  a(x.codegen, x.buffers, x.textures, x.kernels, x.regions, x.depth, x.content, x.time_slots, x.statistics);
}

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::same_as<T, std::byte>;

// ---- the two directions ----

class Writer {
 public:
  template <class... T>
  void operator()(T&... values) {
    (write(values), ...);
  }
  void name_of(const KernelSpec& spec) { write_text(spec.name); }

  std::string bytes;

 private:
  template <Plain T>
  void write(T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void write_size(std::uint64_t size) { write(size); }
  void write_text(std::string_view text) {
    write_size(text.size());
    bytes += text;
  }
  void write(std::string& text) { write_text(text); }
  template <class T>
  void write(std::vector<T>& list) {
    write_size(list.size());
    if constexpr (Plain<T>) {
      bytes.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
    } else {
      for (T& element : list) write(element);
    }
  }
  template <class T>
  void write(T& value) {
    fields(*this, value);
  }
};

/// Reads what is there. Once something is missing, `is_whole` is false and nothing more is read.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <class... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  void name_of(KernelSpec& spec) {
    std::string name;
    read(name);
    const auto known = std::ranges::find(kernel_specs, name, &KernelSpec::name);
    is_whole_ = is_whole_ && known != kernel_specs.end();
    if (is_whole_) spec = *known;
  }

  bool is_whole() const { return is_whole_ && rest_.empty(); }

 private:
  /// Nothing if there are not so many bytes.
  std::string_view take(std::uint64_t count) {
    is_whole_ = is_whole_ && count <= rest_.size();
    if (!is_whole_) return {};
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }
  template <Plain T>
  void read(T& value) {
    const std::string_view bytes = take(sizeof(T));
    if constexpr (std::same_as<T, bool>) {
      is_whole_ = is_whole_ && static_cast<unsigned char>(bytes[0]) <= 1;
      value = is_whole_ && bytes[0] != 0;
    } else if (is_whole_) {
      std::memcpy(&value, bytes.data(), sizeof(T));
    }
  }
  void read(std::string& text) {
    std::uint64_t size = 0;
    read(size);
    text = take(size);
  }
  template <class T>
  void read(std::vector<T>& list) {
    std::uint64_t size = 0;
    read(size);
    if constexpr (Plain<T>) {
      const std::string_view bytes = size <= rest_.size() ? take(size * sizeof(T)) : take(size);
      if (!is_whole_) return;
      list.resize(size);
      if (size != 0) std::memcpy(list.data(), bytes.data(), bytes.size());
    } else {
      is_whole_ = is_whole_ && ++nested_ <= most_nested;
      for (std::uint64_t i = 0; i < size && is_whole_; ++i) read(list.emplace_back());
      --nested_;
    }
  }
  template <class T>
  void read(T& value) {
    fields(*this, value);
  }

  std::string_view rest_;
  bool is_whole_ = true;
  std::uint32_t nested_ = 0;
};

// ---- whether a device could run it ----

std::string fault_of(const Buffer& buffer) {
  const SceneBuffer* const row = find_scene_buffer(buffer.binding);
  if (row == nullptr || buffer.name != row->name)
    return fmt::format("the buffer '{}' at no place of its own", buffer.name);
  if (buffer.form != BufferForm::records && buffer.form != row->as_texels)
    return fmt::format("the buffer '{}' in a form that it never has", buffer.name);
  const std::size_t elements = buffer.bytes.size() / row->element_bytes;
  if (elements != std::max<std::size_t>(buffer.count, 1) || elements * row->element_bytes != buffer.bytes.size())
    return fmt::format("the buffer '{}' with {} bytes for {} elements", buffer.name, buffer.bytes.size(), buffer.count);
  return {};
}

std::string fault_of(const Texture& texture) {
  if (texture.binding != DMVV_BIND_GRID_ATLAS && texture.binding != DMVV_BIND_BITMAP_ATLAS)
    return fmt::format("the texture '{}' at no place of its own", texture.name);
  const glm::uvec3& e = texture.extent;
  const std::uint32_t longest = std::max({e.x, e.y, e.z}), shortest = std::min({e.x, e.y, e.z});
  if (shortest == 0 || longest > longest_extent || texture.format > TexelFormat::rgba16f ||
      texture.texels.size() != std::size_t{e.x} * e.y * e.z * bytes_per_texel(texture.format))
    return fmt::format("the texture '{}' with {} bytes for {} x {} x {} texels", texture.name, texture.texels.size(),
                       e.x, e.y, e.z);
  return {};
}

std::string fault_of(const Kernel& kernel) {
  if (kernel.shaders.empty() || kernel.shaders.size() > DMVV_MOST_STAGES) return "a kernel with no or too many shaders";
  for (const Shader& shader : kernel.shaders) {
    if (shader.spirv.empty()) continue;
    if (const std::string log = validate_spirv(shader.spirv); !log.empty())
      return fmt::format("a kernel '{}' that is no valid SPIR-V: {}", kernel.spec.name, log);
  }
  return {};
}

std::string fault_of(const snippet::TimeSlot& slot) {
  if (slot.period > snippet::Period::one) return "a time value of no known period";
  const std::string fault = snippet::fault_of(slot.program);
  return fault.empty() ? "" : "a time value with " + fault;
}

template <class T>
std::string first_fault(const std::vector<T>& list) {
  for (const T& element : list) {
    if (std::string fault = fault_of(element); !fault.empty()) return fault;
  }
  return {};
}

std::string fault_of(const Program& program) {
  std::set<std::uint32_t> bindings;
  for (const Buffer& buffer : program.buffers) bindings.insert(buffer.binding);
  for (const Texture& texture : program.textures) bindings.insert(texture.binding);
  if (bindings.size() != program.buffers.size() + program.textures.size()) return "two things at one binding";
  const auto times = std::ranges::find(program.buffers, scene_binding::time_values, &Buffer::binding);
  if (program.time_slots.size() != (times == program.buffers.end() ? 0 : times->count))
    return "time values without their buffer";
  if (program.codegen > Codegen::automatic || program.depth == 0 || program.depth > 256)
    return "an impossible depth or form";
  for (std::string fault : {first_fault(program.buffers), first_fault(program.textures), first_fault(program.kernels),
                            first_fault(program.time_slots)}) {
    if (!fault.empty()) return fault;
  }
  return {};
}

std::string hash_of(std::string_view bytes) {
  ContentHash hash;
  hash.add(bytes);
  return hash.digits();
}

}  // namespace

std::string write_program(const Program& program) {
  Writer writer;
  writer(const_cast<Program&>(program));  // one telling of the fields serves both directions; this one only reads them
  std::string bytes(mark);
  bytes.append(reinterpret_cast<const char*>(&format), sizeof format);
  bytes += hash_of(writer.bytes);
  return bytes + writer.bytes;
}

Result<Program> read_program(std::string_view bytes, const std::string& name) {
  const auto refuse = [&](const std::string& why) {
    return fail(Fault::input, fmt::format("cannot load '{}': {}", name, why),
                {"write it anew: dmvv compile SCENE -o DIR"});
  };
  if (!bytes.starts_with(mark)) return refuse("it is no compiled program of dmvv");
  bytes.remove_prefix(mark.size());
  std::uint32_t written = 0;
  if (bytes.size() < sizeof written + hash_digits) return refuse("it ends too early");
  std::memcpy(&written, bytes.data(), sizeof written);
  if (written != format) return refuse(fmt::format("its format is {}; this version reads {}", written, format));
  const std::string_view digits = bytes.substr(sizeof written, hash_digits);
  bytes.remove_prefix(sizeof written + hash_digits);
  if (digits != hash_of(bytes)) return refuse("bytes are missing or were changed");
  Reader reader(bytes);
  Program program;
  reader(program);
  if (!reader.is_whole()) return refuse("it ends too early, or goes on after its end");
  if (const std::string fault = fault_of(program); !fault.empty()) return refuse("it has " + fault);
  return program;
}

}  // namespace dmvv::compiler
