#include "voml/assets.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/limits.h"
#include "base/text.h"
#include "voml/assets/seeds.h"

namespace dmvv::voml {
namespace {

/// Reads a file; what stands in the way is reported at the attribute that names it.
std::optional<std::string> open_asset(const FileName& file, const ReadFile& files, Diagnostics& diagnostics) {
  auto bytes = files(file.path, max_file_bytes);
  if (bytes) return std::move(*bytes);
  std::vector<Note> notes;
  for (const std::string& reason : bytes.error().reasons) notes.push_back({Span{}, reason});
  diagnostics.report(Code::cannot_read_file, file.named_at, bytes.error().message, std::move(notes));
  return std::nullopt;
}

}  // namespace

std::string path_beside(const std::string& from, const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(from).parent_path();
  return (folder / name).lexically_normal().generic_string();  // an absolute name replaces the folder
}

// ---- naming ----

Id<Grid> Assets::add_grid(Scene& scene, const FileName& file) {
  const auto [entry, is_new] = grids_.try_emplace(file.path);
  if (is_new) {
    entry->second = append(scene.grids, Grid{});
    scene.grids.back().path = file.path;
    grid_files_.push_back(file);
  }
  return entry->second;
}

Id<Bitmap> Assets::add_bitmap(Scene& scene, const FileName& file) {
  const auto [entry, is_new] = bitmaps_.try_emplace(file.path);
  if (is_new) {
    entry->second = append(scene.bitmaps, Bitmap{});
    scene.bitmaps.back().path = file.path;
    bitmap_files_.push_back(file);
  }
  return entry->second;
}

Id<SeedList> Assets::add_seeds(Scene& scene, const SeedFiles& files) {
  const std::string key = fmt::format("{}\n{}\n{}", files.seeds.path, files.rotates.path, files.scales.path);
  const auto [entry, is_new] = seed_lists_.try_emplace(key);
  if (is_new) {
    entry->second = append(scene.seed_lists, SeedList{files.seeds.path, {}});
    seed_files_.push_back(files);
  }
  return entry->second;
}

// ---- grids and bitmaps ----

void Assets::load(Scene& scene, Id<Grid> grid, const ReadFile& files, Diagnostics& diagnostics) {
  const FileName& file = at(grid_files_, Id<FileName>{grid.index});
  const auto bytes = open_asset(file, files, diagnostics);
  if (!bytes) return;
  Diagnostics faults;  // a binary file has no lines to point at: its faults stand where it is named
  auto parsed = parse_lxn(*bytes, faults.add_source(file.path, {}), faults);
  for (const Diagnostic& fault : faults.all()) {
    diagnostics.report(fault.code, file.named_at, fmt::format("grid {}: {}", in_quotes(file.path), fault.message));
  }
  if (parsed) at(scene.grids, grid) = std::move(*parsed);
}

void Assets::load(Scene& scene, Id<Bitmap> bitmap, const ReadFile& files, Diagnostics& diagnostics) {
  const FileName& file = at(bitmap_files_, Id<FileName>{bitmap.index});
  const auto bytes = open_asset(file, files, diagnostics);
  if (!bytes) return;
  auto parsed = parse_bitmap(*bytes, file.path, file.named_at, diagnostics);
  if (parsed) at(scene.bitmaps, bitmap) = std::move(*parsed);
}

// ---- seeds ----

const Assets::VectorFile& Assets::vector_file(const FileName& file, const ReadFile& files, Diagnostics& diagnostics) {
  const auto [entry, is_new] = vector_files_.try_emplace(file.path);
  if (is_new) {
    if (auto text = open_asset(file, files, diagnostics)) {
      entry->second.source = diagnostics.add_source(file.path, std::move(*text));
      entry->second.vectors = parse_vectors(entry->second.source, diagnostics);
    }
  }
  return entry->second;
}

bool Assets::check_seeds(const SeedFiles& names, const VectorFile& seeds, const VectorFile* rotates,
                         const VectorFile* scales, Diagnostics& diagnostics) {
  const std::size_t count = seeds.vectors->size();
  bool good = true;
  const auto check_count = [&](const VectorFile* file, const FileName& name) {
    if (file == nullptr || file->vectors->size() == count) return;
    diagnostics.report(Code::seed_count, name.named_at,
                       fmt::format("{} has {} lines of numbers, but the seed file {} has {}", in_quotes(name.path),
                                   file->vectors->size(), in_quotes(names.seeds.path), count));
    good = false;
  };
  check_count(rotates, names.rotates);
  check_count(scales, names.scales);
  for (std::size_t i = 0; scales != nullptr && i < scales->vectors->size(); ++i) {
    const glm::dvec3 scale = (*scales->vectors)[i];
    if (usable_scale(scale.x) && usable_scale(scale.y) && usable_scale(scale.z)) continue;
    diagnostics.report(Code::zero_scale, vector_span(scales->source, i, diagnostics),
                       fmt::format("a component of the scale ({}, {}, {}) is zero", scale.x, scale.y, scale.z));
    good = false;
    break;
  }
  if (count == 0) {
    diagnostics.report(Code::no_seeds, names.seeds.named_at,
                       fmt::format("the seed file {} holds no seed", in_quotes(names.seeds.path)));
  }
  return good;
}

void Assets::load(Scene& scene, Id<SeedList> list, const ReadFile& files, Diagnostics& diagnostics) {
  const SeedFiles& names = at(seed_files_, Id<SeedFiles>{list.index});
  const auto optional_file = [&](const FileName& name) {
    return name.path.empty() ? nullptr : &vector_file(name, files, diagnostics);
  };
  const VectorFile& seeds = vector_file(names.seeds, files, diagnostics);
  const VectorFile* rotates = optional_file(names.rotates);
  const VectorFile* scales = optional_file(names.scales);
  const auto broken = [](const VectorFile* file) { return file != nullptr && !file->vectors; };
  if (broken(&seeds) || broken(rotates) || broken(scales)) return;
  if (!check_seeds(names, seeds, rotates, scales, diagnostics)) return;

  const std::size_t count = seeds.vectors->size();
  if (count > max_seeds - seeds_) {
    diagnostics.report(
        Code::too_many_seeds, names.seeds.named_at,
        fmt::format("the scene has {} seeds up to here, at most {} are allowed", seeds_ + count, max_seeds));
    return;
  }
  seeds_ += count;
  std::vector<Seed>& result = at(scene.seed_lists, list).seeds;
  result.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    result[i].position = (*seeds.vectors)[i];
    if (rotates != nullptr) result[i].rotate_deg = (*rotates->vectors)[i];
    if (scales != nullptr) result[i].scale = (*scales->vectors)[i];
  }
}

}  // namespace dmvv::voml
