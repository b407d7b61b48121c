// The table of elements; authoring/molecule.h names its sources.
#include <algorithm>
#include <cctype>

#include "authoring/molecule.h"

namespace dmvv::authoring {
namespace {

// symbol, radius (B: Bondi 1964, otherwise Alvarez 2013), colour
constexpr Element table[] = {
    {"H", 1.20, 0xffffff},                                                                           // B
    {"He", 1.40, 0xd9ffff},                                                                          // B
    {"Li", 2.12, 0xcc80ff}, {"Be", 1.98, 0xc2ff00}, {"B", 1.91, 0xffb5b5},  {"C", 1.70, 0x909090},   // B
    {"N", 1.55, 0x3050f8},                                                                           // B
    {"O", 1.52, 0xff0d0d},                                                                           // B
    {"F", 1.47, 0x90e050},                                                                           // B
    {"Ne", 1.54, 0xb3e3f5},                                                                          // B
    {"Na", 2.50, 0xab5cf2}, {"Mg", 2.51, 0x8aff00}, {"Al", 2.25, 0xbfa6a6}, {"Si", 2.10, 0xf0c8a0},  // B
    {"P", 1.80, 0xff8000},                                                                           // B
    {"S", 1.80, 0xffff30},                                                                           // B
    {"Cl", 1.75, 0x1ff01f},                                                                          // B
    {"Ar", 1.88, 0x80d1e3},                                                                          // B
    {"K", 2.73, 0x8f40d4},  {"Ca", 2.62, 0x3dff00}, {"Sc", 2.58, 0xe6e6e6}, {"Ti", 2.46, 0xbfc2c7},
    {"V", 2.42, 0xa6a6ab},  {"Cr", 2.45, 0x8a99c7}, {"Mn", 2.45, 0x9c7ac7}, {"Fe", 2.44, 0xe06633},
    {"Co", 2.40, 0xf090a0}, {"Ni", 2.40, 0x50d050}, {"Cu", 2.38, 0xc88033}, {"Zn", 2.39, 0x7d80b0},
    {"Ga", 2.32, 0xc28f8f}, {"Ge", 2.29, 0x668f8f}, {"As", 1.85, 0xbd80e3},  // B
    {"Se", 1.90, 0xffa100},                                                  // B
    {"Br", 1.85, 0xa62929},                                                  // B
    {"Kr", 2.02, 0x5cb8d1},                                                  // B
    {"Rb", 3.21, 0x702eb0}, {"Sr", 2.84, 0x00ff00}, {"Y", 2.75, 0x94ffff},  {"Zr", 2.52, 0x94e0e0},
    {"Nb", 2.56, 0x73c2c9}, {"Mo", 2.45, 0x54b5b5}, {"Tc", 2.44, 0x3b9e9e}, {"Ru", 2.46, 0x248f8f},
    {"Rh", 2.44, 0x0a7d8c}, {"Pd", 2.15, 0x006985}, {"Ag", 2.53, 0xc0c0c0}, {"Cd", 2.49, 0xffd98f},
    {"In", 2.43, 0xa67573}, {"Sn", 2.42, 0x668080}, {"Sb", 2.47, 0x9e63b5}, {"Te", 2.06, 0xd47a00},  // B
    {"I", 1.98, 0x940094},                                                                           // B
    {"Xe", 2.16, 0x429eb0},                                                                          // B
    {"Cs", 3.48, 0x57178f}, {"Ba", 3.03, 0x00c900}, {"La", 2.98, 0x70d4ff}, {"Ce", 2.88, 0xffffc7},
    {"Pr", 2.92, 0xd9ffc7}, {"Nd", 2.95, 0xc7ffc7}, {"Sm", 2.90, 0x8fffc7}, {"Eu", 2.87, 0x61ffc7},
    {"Gd", 2.83, 0x45ffc7}, {"Tb", 2.79, 0x30ffc7}, {"Dy", 2.87, 0x1fffc7}, {"Ho", 2.81, 0x00ff9c},
    {"Er", 2.83, 0x00e675}, {"Tm", 2.79, 0x00d452}, {"Yb", 2.80, 0x00bf38}, {"Lu", 2.74, 0x00ab24},
    {"Hf", 2.63, 0x4dc2ff}, {"Ta", 2.53, 0x4da6ff}, {"W", 2.57, 0x2194d6},  {"Re", 2.49, 0x267dab},
    {"Os", 2.48, 0x266696}, {"Ir", 2.41, 0x175487}, {"Pt", 2.29, 0xd0d0e0}, {"Au", 2.32, 0xffd123},
    {"Hg", 2.45, 0xb8b8d0}, {"Tl", 2.47, 0xa6544d}, {"Pb", 2.60, 0x575961}, {"Bi", 2.54, 0x9e4fb5},
    {"Th", 2.93, 0x00baff}, {"U", 2.71, 0x008fff},
};

bool same_letters(std::string_view a, std::string_view b) {
  const auto upper = [](char c) { return std::toupper(static_cast<unsigned char>(c)); };
  return std::ranges::equal(a, b, {}, upper, upper);
}

}  // namespace

std::span<const Element> elements() { return table; }

const Element* find_element(std::string_view symbol) {
  if (same_letters(symbol, "D")) symbol = "H";
  const auto found = std::ranges::find_if(table, [&](const Element& e) { return same_letters(e.symbol, symbol); });
  return found == std::end(table) ? nullptr : &*found;
}

}  // namespace dmvv::authoring
