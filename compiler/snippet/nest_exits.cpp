// A branch of which one side never ends takes what follows it into its other side.
#include "compiler/snippet/nest_exits.h"

#include <algorithm>
#include <iterator>

namespace dmvv::compiler::snippet {

namespace {

constexpr int most_nested = 60;  // branches that replace the exits of a block

/// Does control never come to the end of a sequence?
bool never_ends(const Sequence& sequence) {
  if (sequence.empty()) return false;
  const Node& last = sequence.back();
  if (last.kind == Node::Kind::leave || last.kind == Node::Kind::repeat) return true;
  return last.kind == Node::Kind::branch && never_ends(last.body) && never_ends(last.other);
}

}  // namespace

bool leaves(const Sequence& sequence) {
  return std::ranges::any_of(sequence, [](const Node& node) {
    if (node.kind == Node::Kind::leave) return true;
    return node.kind == Node::Kind::branch && (leaves(node.body) || leaves(node.other));
  });
}

void nest(Sequence& sequence, int depth) {
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    Node& node = sequence[i];
    if (node.kind == Node::Kind::leave) return sequence.resize(i);
    if (node.kind != Node::Kind::branch || !(leaves(node.body) || leaves(node.other))) continue;
    const bool left = never_ends(node.body), right = never_ends(node.other), is_last = i + 1 == sequence.size();
    if (depth > most_nested || !(left || right || is_last)) return;
    Sequence& takes_rest = left ? node.other : node.body;
    takes_rest.insert(takes_rest.end(), std::make_move_iterator(sequence.begin() + static_cast<std::ptrdiff_t>(i) + 1),
                      std::make_move_iterator(sequence.end()));
    nest(node.body, depth + 1);
    nest(node.other, depth + 1);
    return sequence.resize(i + 1);
  }
}

}  // namespace dmvv::compiler::snippet
