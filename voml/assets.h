// Inside voml: the files that a scene names: noted while the document is read, opened once it is known which are
// needed.
#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "voml/scene.h"

namespace dmvv::voml {

/// A file and the attribute that names it. An empty path: no file.
struct FileName {
  std::string path;  ///< joined to the folder of the file that names it, normalised
  Span named_at;
};

struct SeedFiles {
  FileName seeds;
  FileName rotates;
  FileName scales;
};

/// `name` as seen from the folder of the file `from`, normalised: one file has one path.
std::string path_beside(const std::string& from, const std::string& name);

/// The assets of one scene.
class Assets {
 public:
  // Each file, or combination of seed files, gives one asset however often it is named.
  Id<Grid> add_grid(Scene& scene, const FileName& file);
  Id<Bitmap> add_bitmap(Scene& scene, const FileName& file);
  Id<SeedList> add_seeds(Scene& scene, const SeedFiles& files);

  // Opens and checks an asset; faults of binary files are reported at the attribute that names them, faults of seed
  // files at their lines.
  void load(Scene& scene, Id<Grid> grid, const ReadFile& files, Diagnostics& diagnostics);
  void load(Scene& scene, Id<Bitmap> bitmap, const ReadFile& files, Diagnostics& diagnostics);
  void load(Scene& scene, Id<SeedList> list, const ReadFile& files, Diagnostics& diagnostics);

 private:
  /// A seed, rotate or scale file that has been read; a file may serve several lists.
  struct VectorFile {
    SourceId source;
    std::optional<std::vector<glm::dvec3>> vectors;  ///< empty if the file has faults
  };
  const VectorFile& vector_file(const FileName& file, const ReadFile& files, Diagnostics& diagnostics);
  bool check_seeds(const SeedFiles& names, const VectorFile& seeds, const VectorFile* rotates, const VectorFile* scales,
                   Diagnostics& diagnostics);

  std::vector<FileName> grid_files_;    // parallel to Scene::grids
  std::vector<FileName> bitmap_files_;  // parallel to Scene::bitmaps
  std::vector<SeedFiles> seed_files_;   // parallel to Scene::seed_lists
  std::unordered_map<std::string, Id<Grid>> grids_;
  std::unordered_map<std::string, Id<Bitmap>> bitmaps_;
  std::unordered_map<std::string, Id<SeedList>> seed_lists_;
  std::unordered_map<std::string, VectorFile> vector_files_;
  std::size_t seeds_ = 0;  // in all lists
};

}  // namespace dmvv::voml
