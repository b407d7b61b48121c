// A VOML file and its imports -> Draft.
#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "voml/attributes.h"
#include "voml/draft.h"
#include "voml/limits.h"
#include "voml/object_reader.h"

namespace dmvv::voml {
namespace {

class DocumentReader {
 public:
  DocumentReader(const ReadFile& files, Draft& draft, Diagnostics& diagnostics)
      : files_(files), draft_(draft), diagnostics_(diagnostics) {}

  void read(const std::string& path);

 private:
  /// A file that is being read: its imports are read where they stand. Without recursion: chains may be long.
  struct OpenFile {
    std::string path;
    std::unique_ptr<XmlDocument> document;
    Span root;
    Children children;
    std::size_t index;  ///< into Draft::document_blocks
    std::size_t next = 0;
  };

  bool open(const std::string& path, Span named_at);
  void import(Element element);
  void use_functions_of(std::size_t imported);
  void report_import_cycle(const std::string& path, Span named_at);

  const ReadFile& files_;
  Draft& draft_;
  Diagnostics& diagnostics_;
  std::size_t elements_left_ = max_elements;
  std::vector<std::unique_ptr<OpenFile>> open_;        // importing files first
  std::unordered_map<std::string, std::size_t> seen_;  // path -> index into Draft::document_blocks
};

void DocumentReader::read(const std::string& path) {
  if (!open(path, Span{})) {
    draft_.incomplete = true;
    return;
  }
  const Span root = open_.front()->root;
  const std::vector<std::size_t> unknown = open_.front()->children.unknown;
  while (!open_.empty()) {
    OpenFile& file = *open_.back();
    if (file.next == file.children.elements.size()) {
      const std::size_t read = file.index;
      open_.pop_back();
      if (!open_.empty()) use_functions_of(read);
      continue;
    }
    const Element element = file.children.elements[file.next++];
    if (element.tag() == Tag::import_file) {
      import(element);
    } else if (element.tag() == Tag::functions) {
      read_functions(element, draft_.document_blocks[file.index], draft_, diagnostics_);
    } else {
      const Id<Object> object = read_object(element, {file.path, file.index}, draft_, diagnostics_);
      if (open_.size() == 1) draft_.last_object = object;
    }
  }
  if (!draft_.scene.objects.empty()) {
    if (!draft_.last_object.valid()) draft_.last_object = {static_cast<std::uint32_t>(draft_.scene.objects.size() - 1)};
  } else if (!draft_.incomplete && !blame_misspelt({{}, unknown}, Tag::object, draft_)) {
    diagnostics_.report(Code::no_object, root, "the scene defines no OBJECT");
  }
}

bool DocumentReader::open(const std::string& path, Span named_at) {
  const std::size_t index = draft_.document_blocks.size();
  draft_.document_blocks.emplace_back();
  seen_.emplace(path, index);
  auto text = files_(path, max_file_bytes);
  if (!text) {
    diagnostics_.report(Code::cannot_read_file, named_at, text.error().message);
    return false;
  }
  auto document = XmlDocument::parse(diagnostics_.add_source(path, std::move(*text)), elements_left_, diagnostics_);
  if (!document) return false;
  const Element root{document.get(), document->root()};
  if (!check_root(root, diagnostics_)) return false;
  Attributes(root, diagnostics_).report_unknown();
  Children children = children_of(root, {Tag::object, Tag::import_file, Tag::functions}, false, draft_, diagnostics_);
  open_.push_back(
      std::make_unique<OpenFile>(OpenFile{path, std::move(document), root.name_span(), std::move(children), index}));
  return true;
}

void DocumentReader::import(Element element) {
  Attributes attributes(element, diagnostics_);
  const auto name = attributes.required_text("file");
  attributes.report_unknown();
  children_of(element, {}, false, draft_, diagnostics_);
  if (!name) {
    draft_.incomplete = true;
    return;
  }
  const Span named_at = attributes.span("file");
  const std::string path = path_beside(open_.back()->path, *name);
  if (const auto seen = seen_.find(path); seen != seen_.end()) {
    const bool is_open = std::any_of(open_.begin(), open_.end(), [&](const auto& file) { return file->path == path; });
    if (is_open) report_import_cycle(path, named_at);
    if (!is_open) use_functions_of(seen->second);
    return;  // a file that two others import is read once
  }
  if (seen_.size() >= max_documents) {
    diagnostics_.report(Code::scene_too_large, named_at,
                        fmt::format("the scene has more than {} files up to here", max_documents));
    draft_.incomplete = true;
  } else if (!open(path, named_at)) {
    draft_.incomplete = true;
  }
}

/// The file that is being read may use what the imported one may use.
void DocumentReader::use_functions_of(std::size_t imported) {
  std::vector<std::size_t>& own = draft_.document_blocks[open_.back()->index];
  for (const std::size_t block : draft_.document_blocks[imported]) {
    if (own.size() > max_function_blocks) return;  // refused by connect_functions
    if (std::find(own.begin(), own.end(), block) == own.end()) own.push_back(block);
  }
}

void DocumentReader::report_import_cycle(const std::string& path, Span named_at) {
  std::vector<std::string_view> chain;
  for (const auto& file : open_) {
    if (!chain.empty() || file->path == path) chain.push_back(file->path);
  }
  chain.push_back(path);
  diagnostics_.report(Code::import_cycle, named_at,
                      fmt::format("{} imports itself: {}", in_quotes(path), shortened_chain(chain)));
}

}  // namespace

void read_documents(const std::string& path, const ReadFile& files, Draft& draft, Diagnostics& diagnostics) {
  DocumentReader(files, draft, diagnostics).read(path);
}

void connect_functions(Draft& draft, Diagnostics& diagnostics) {
  std::size_t all_bytes = 0;
  for (std::size_t i = 0; i < draft.scene.functions.size(); ++i) {
    const ObjectNames& object = draft.names[draft.function_objects[i].index];
    std::vector<std::size_t> blocks = draft.document_blocks[object.document];
    blocks.insert(blocks.end(), object.function_blocks.begin(), object.function_blocks.end());
    std::size_t bytes = 0;
    for (const std::size_t block : blocks) bytes += draft.function_blocks[block].content.text.size();
    all_bytes += bytes;
    if (blocks.size() > max_function_blocks || bytes > max_helper_bytes || all_bytes > max_all_helper_bytes) {
      diagnostics.report(
          Code::scene_too_large, draft.function_blocks[blocks.back()].span,
          fmt::format("the FUNCTIONS that one SDF may use are at most {} with {} bytes of text, those of "
                      "all SDFs together {} bytes; up to here there are {} with {} bytes, and {} bytes",
                      max_function_blocks, max_helper_bytes, max_all_helper_bytes, blocks.size(), bytes, all_bytes));
      return;
    }
    std::vector<GlslText>& helpers = draft.scene.functions[i].helpers;
    for (const std::size_t block : blocks) helpers.push_back(draft.function_blocks[block].content);
  }
}

}  // namespace dmvv::voml
