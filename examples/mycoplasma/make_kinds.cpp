// Names, colours and radii of the molecules of the cell: make_kinds INGREDIENTS.tsv KINDS.tsv
//
// The ingredients are `entity name instances beads`, their names root.mge.surface.proteins.MG_086_MONOMER. What is
// called by a number only is coloured by its place: the membrane's proteins in blues, those within in greens and
// browns.
#include <array>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

namespace {

struct Look {
  std::string_view part;  ///< of the name behind its last '.'; with "=" before it, that name
  std::string_view rgb;
  std::string_view radius;
};

/// The first whose part occurs in the name. The beads of nucleic acids are a thread, 36 A apart; their radius here is
/// half of that, so that they touch.
constexpr Look known[] = {
    {"DNA_POLYMERASE", "#8e44ad", ""}, {"RNA_POLYMERASE", "#6c3fb0", ""}, {"RIBOSOME_70S", "#e0b64a", ""},
    {"RIBOSOME_50S", "#edd07a", ""},   {"RIBOSOME_30S", "#c99a2e", ""},   {"tRNA", "#f08a4b", ""},
    {"192MER", "#b5485d", ""},         {"21MER", "#7d5ba6", ""},          {"=DNA", "#c0392b", "18"},
    {"=RNA", "#ef7d57", "18"},
};

constexpr std::array<std::string_view, 5> surface{"#2f6fb0", "#4a8fd0", "#2b8f9e", "#6aa9dc", "#3f5fa8"};
constexpr std::array<std::string_view, 7> interior{"#5d9c59", "#86b36b", "#3f7f5f", "#a8c686",
                                                   "#7a9a55", "#4f8a78", "#9aa86a"};

Look look_of(const std::string& path, std::uint32_t entity) {
  const std::string_view name = std::string_view(path).substr(path.rfind('.') + 1);
  for (const Look& look : known)
    if (look.part[0] == '=' ? name == look.part.substr(1) : name.find(look.part) != name.npos) return look;
  const bool outside = path.find(".surface.") != path.npos;
  return {name, outside ? surface[entity % surface.size()] : interior[entity % interior.size()], ""};
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fputs("usage: make_kinds INGREDIENTS.tsv KINDS.tsv\n", stderr);
    return 2;
  }
  std::ifstream input(words[1]);
  std::ofstream output(words[2], std::ios::binary);
  output << "kind\tname\trgb\tradius\n";
  std::string line;
  std::getline(input, line);  // entity name instances beads
  std::size_t kinds = 0;
  while (std::getline(input, line)) {
    std::istringstream row(line);
    std::uint32_t entity = 0;
    std::string path;
    if (!(row >> entity >> path)) {
      std::fprintf(stderr, "make_kinds: %s: '%s' is no ingredient\n", words[1], line.c_str());
      return 1;
    }
    const Look look = look_of(path, entity);
    output << entity << '\t' << path.substr(path.rfind('.') + 1) << '\t' << look.rgb << '\t' << look.radius << '\n';
    ++kinds;
  }
  output.close();
  if (kinds != 0 && output) return 0;
  std::fprintf(stderr, "make_kinds: cannot read %s or write %s\n", words[1], words[2]);
  return 1;
}
