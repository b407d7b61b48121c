// A VOML file and its imports -> Draft.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <unordered_map>
#include <utility>

#include "base/limits.h"
#include "voml/attributes.h"
#include "voml/draft.h"
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
      const std::size_t known = draft_.function_blocks.size();
      read_functions(element, draft_.document_blocks[file.index], draft_, diagnostics_);
      if (draft_.function_blocks.size() > known) {
        draft_.function_blocks.back().document = file.index;
        draft_.function_blocks.back().imports = static_cast<std::uint32_t>(draft_.document_imports[file.index].size());
      }
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
  draft_.document_imports.emplace_back();
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
  std::vector<std::size_t>& imports = draft_.document_imports[open_.back()->index];
  const auto add = [&](std::size_t document) {
    if (std::find(imports.begin(), imports.end(), document) == imports.end()) imports.push_back(document);
  };
  const std::vector<std::size_t>& blocks = draft_.document_blocks[imported];
  const bool has_functions = std::any_of(blocks.begin(), blocks.end(), [&](std::size_t block) {
    return draft_.function_blocks[block].document == imported;
  });
  if (has_functions) return add(imported);
  for (const std::size_t document : draft_.document_imports[imported]) add(document);  // it passes on what it imports
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

namespace {

/// A document's files with FUNCTIONS, itself the last, and their numbers in that list.
struct FilesOfDocument {
  std::shared_ptr<const std::vector<FunctionFile>> files;
  std::unordered_map<std::size_t, std::uint32_t> numbers;
};

FilesOfDocument files_of(const Draft& draft, std::size_t document) {
  FilesOfDocument result;
  auto files = std::make_shared<std::vector<FunctionFile>>();
  std::vector<std::pair<std::size_t, std::size_t>> open = {{document, 0}};  // documents, and how many imports are done
  while (!open.empty()) {
    const std::size_t file = open.back().first;
    const std::vector<std::size_t>& imports = draft.document_imports[file];
    if (open.back().second < imports.size()) {
      const std::size_t next = imports[open.back().second++];
      if (!result.numbers.contains(next)) open.emplace_back(next, 0);
      continue;
    }
    open.pop_back();
    if (!result.numbers.emplace(file, static_cast<std::uint32_t>(files->size())).second) continue;
    FunctionFile& numbered = files->emplace_back();
    for (const std::size_t import : imports) numbered.imports.push_back(result.numbers.at(import));
  }
  result.files = std::move(files);
  return result;
}

}  // namespace

void connect_functions(Draft& draft, Diagnostics& diagnostics) {
  std::size_t all_bytes = 0;
  std::unordered_map<std::size_t, FilesOfDocument> known;
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
    const auto [files, is_new] = known.try_emplace(object.document);
    if (is_new) files->second = files_of(draft, object.document);
    Function& function = draft.scene.functions[i];
    function.files = files->second.files;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const FunctionBlock& block = draft.function_blocks[blocks[k]];
      const bool is_of_object = k >= draft.document_blocks[object.document].size();
      function.helpers.push_back(block.content);
      function.places.push_back(is_of_object ? HelperPlace{static_cast<std::uint32_t>(function.files->size()), 0}
                                             : HelperPlace{files->second.numbers.at(block.document), block.imports});
    }
  }
}

}  // namespace dmvv::voml
