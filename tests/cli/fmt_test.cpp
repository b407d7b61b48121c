// dmvv fmt: which files change and how; and every scene of ours is laid out canonically.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "tests/cli/program.h"

using namespace dmvv::tests;

namespace {
namespace fs = std::filesystem;
constexpr const char* loose = "<MVV><OBJECT name='A'>\n<REGION type='empty' name='R'/></OBJECT></MVV>";
constexpr const char* canonical =
    "<MVV>\n  <OBJECT name=\"A\">\n    <REGION name=\"R\" type=\"empty\"/>\n  </OBJECT>\n</MVV>\n";
constexpr const char* broken = "<MVV><OBJECT></MVV>";
}  // namespace

TEST_CASE("in place, and once only") {
  const Folder folder;
  const std::string a = folder.write("a.voml", loose), b = folder.write("b.voml", canonical);
  const auto written = fs::last_write_time(b);
  const Run run = run_dmvv({"fmt", a, b});
  CHECK(run.exit_code == 0);
  CHECK(run.err.empty());
  CHECK(run.out == a + ": formatted\n");
  CHECK(folder.read("a.voml") == canonical);
  CHECK(fs::last_write_time(b) == written);
  CHECK(run_dmvv({"fmt", a, b}).out.empty());
  CHECK(folder.listing().size() == 2);
}

TEST_CASE("--check changes nothing and names what differs") {
  const Folder folder;
  const std::string a = folder.write("a.voml", loose), b = folder.write("b.voml", canonical);
  const Run run = run_dmvv({"fmt", "--check", b, a});
  CHECK(run.exit_code == 1);
  CHECK(run.out == a + ": not in canonical layout\n");
  CHECK(folder.read("a.voml") == loose);
  CHECK(run_dmvv({"fmt", "--check", b}).exit_code == 0);
  CHECK(run_dmvv({"fmt", "--check", "-"}, loose).exit_code == 1);
  CHECK(run_dmvv({"fmt", "--check", "-"}, canonical).exit_code == 0);
}

TEST_CASE("from the standard input to the standard output") {
  const Run run = run_dmvv({"fmt", "-"}, loose);
  CHECK(run.exit_code == 0);
  CHECK(run.out == canonical);
  CHECK(run_dmvv({"fmt", "-", "-"}, loose).exit_code == 2);
  CHECK(run_dmvv({"fmt"}).exit_code == 2);
  const Run bad = run_dmvv({"fmt", "-"}, broken);
  CHECK(bad.exit_code == 1);
  CHECK(bad.out.empty());
  CHECK(bad.err.find("<stdin>:1:16: error[E0002]") != std::string::npos);
}

TEST_CASE("a file in another encoding becomes UTF-8 and says so; one with meaningless bytes stays as it is") {
  const Folder folder;
  const std::string body =
      "<MVV>\n  <OBJECT name=\"%\">\n    <REGION name=\"R\" type=\"empty\"/>\n  </OBJECT>\n</MVV>\n";
  const auto named = [&](const std::string& name) { return std::string(body).replace(body.find('%'), 1, name); };
  const std::string latin = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n" + named("Sch\xe4le");
  const std::string a = folder.write("a.voml", latin);
  CHECK(run_dmvv({"fmt", "--check", a}).exit_code == 1);
  CHECK(folder.read("a.voml") == latin);
  CHECK(run_dmvv({"fmt", a}).exit_code == 0);
  CHECK(folder.read("a.voml") == "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + named("Sch\xc3\xa4le"));
  CHECK(run_dmvv({"fmt", a}).out.empty());
  const std::string unsaid = named("Sch\xe4le"), b = folder.write("b.voml", unsaid);
  const Run run = run_dmvv({"fmt", b});
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("b.voml:2:20: error[E0003]: the byte e4 is not UTF-8; ") != std::string::npos);
  CHECK(folder.read("b.voml") == unsaid);
}

TEST_CASE("a malformed file stays as it is, the others are formatted") {
  const Folder folder;
  const std::string a = folder.write("a.voml", broken), b = folder.write("b.voml", loose);
  const Run run = run_dmvv({"fmt", a, b});
  CHECK(run.exit_code == 1);
  CHECK(run.err.find("a.voml:1:16: error[E0002]") != std::string::npos);
  CHECK(folder.read("a.voml") == broken);
  CHECK(folder.read("b.voml") == canonical);
  const Run absent = run_dmvv({"fmt", folder.file("none.voml")});
  CHECK(absent.exit_code == 1);
  CHECK(absent.err.find("no such file") != std::string::npos);
  CHECK(folder.listing().size() == 2);
}

TEST_CASE("a link stays a link, permissions stay, read-only files are refused") {
  const Folder folder;
  const std::string a = folder.write("a.voml", loose), link = folder.file("link.voml");
  fs::create_symlink("a.voml", link);
  REQUIRE(chmod(a.c_str(), 0640) == 0);
  CHECK(run_dmvv({"fmt", link}).exit_code == 0);
  CHECK(fs::is_symlink(link));
  CHECK(folder.read("a.voml") == canonical);
  struct stat status {};
  REQUIRE(stat(a.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
  if (geteuid() == 0) return;  // root may write anything
  const std::string b = folder.write("b.voml", loose);
  REQUIRE(chmod(b.c_str(), 0440) == 0);
  CHECK(run_dmvv({"fmt", b}).exit_code == 1);
  CHECK(folder.read("b.voml") == loose);
}

TEST_CASE(
    "the examples, the guide's files, and every scene that dmvv writes, are in canonical layout and valid by the "
    "schema") {
  const Folder folder;
  std::vector<std::string> command{"fmt", "--check"};
  for (const char* const part : {"examples", "spec/guide"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(DMVV_SOURCE_DIR) / part)) {
      if (entry.path().extension() == ".voml") command.push_back(entry.path().string());
    }
  }
  CHECK(command.size() >= 9);
  const auto make = [&](std::vector<std::string> arguments, const std::string& scene) {
    const Run run = run_dmvv(arguments);
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    command.push_back(folder.file(scene));
  };
  make({"new", folder.file("melon")}, "melon.voml");
  const std::string table = folder.write("t.csv", "x,y,z,scale,kind\n-9,0,0,1,a\n9,0,0,1,b & c\n");
  make({"seeds", table, "-o", folder.file("t"), "--voml"}, "t.voml");
  const std::string atoms =
      "REMARK 350 BIOMOLECULE: 1\n"
      "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
      "REMARK 350   BIOMT1   1  1.0  0.0  0.0   0.0\n"
      "REMARK 350   BIOMT2   1  0.0  1.0  0.0   0.0\n"
      "REMARK 350   BIOMT3   1  0.0  0.0  1.0   0.0\n"
      "ATOM      1  C   GLY A   1      10.000   0.000   0.000  1.00 20.00           C  \n"
      "ATOM      2  O   GLY A   1      12.000   0.000   0.000  1.00 20.00           O  \nEND\n";
  const std::string molecule = folder.write("m.pdb", atoms);
  make({"seeds", molecule, "-o", folder.file("m"), "--voml"}, "m.voml");
  make({"seeds", molecule, "-o", folder.file("u"), "--assembly", "1", "--voml"}, "u.voml");
  const std::string packing = folder.write(
      "p.json", R"({"A": {"results": [[[0, 0, 0], [1, 0, 0, 0]]], "positions": [[[0, 0, 0]]], "radii": [[1]]}})");
  make({"seeds", packing, "-o", folder.file("p"), "--voml"}, "p.voml");
  const Run run = run_dmvv(command);
  CHECK_MESSAGE(run.exit_code == 0, run.out << run.err);
  std::string xmllint = DMVV_XMLLINT " --noout --nonet --relaxng '" DMVV_SOURCE_DIR "/spec/voml.rng'";
  for (std::size_t i = 2; i < command.size(); ++i) xmllint += " '" + command[i] + "'";
  const std::string report = folder.file("report");
  CHECK_MESSAGE(std::system((xmllint + " >'" + report + "' 2>&1").c_str()) == 0, read_file(report));
}
