#include <set>

#include "python.hpp"

namespace titop::python {

namespace {

/// The script's files. Diagrams and systems keep these names as long as the process lives.
std::set<std::string>& files() {
  static auto* const names = new std::set<std::string>;
  return *names;
}

}  // namespace

SourceLine here() {
  PyFrameObject* const frame = PyEval_GetFrame();
  if (!frame) return {};
  const auto code =
      py::reinterpret_steal<py::object>(reinterpret_cast<PyObject*>(PyFrame_GetCode(frame)));
  const auto file = code.attr("co_filename").cast<std::string>();
  return {files().insert(file).first->c_str(), PyFrame_GetLineNumber(frame)};
}

void warn(const std::vector<Note>& notes, const std::vector<Note>& known) {
  const py::object category = py::module_::import("titop.errors").attr("CompileWarning");
  for (const Note& note : notes) {
    const auto equal = [&](const Note& n) { return n.pass == note.pass && n.text == note.text; };
    if (note.kind != Note::Kind::warning || std::any_of(known.begin(), known.end(), equal))
      continue;
    if (PyErr_WarnEx(category.ptr(), (note.pass + ": " + note.text).c_str(), 1) < 0)
      throw py::error_already_set();
  }
}

namespace {

/// The place "folder/file.py:12" at the end of a line of a message; "" if there is none. Names of
/// files may have spaces: the longest known one counts.
std::string place_at_end(const std::string& line) {
  const auto digits = line.size() - (line.find_last_not_of("0123456789") + 1);
  std::string place;
  for (const std::string& file : files()) {
    std::string name = to_string(SourceLine(file.c_str(), 1));
    name.pop_back();  // the digit 1
    if (digits == 0 || line.size() < name.size() + digits || name.size() + digits <= place.size())
      continue;
    std::string end = line.substr(line.size() - digits - name.size());
    if (end.compare(0, name.size(), name) == 0) place = std::move(end);
  }
  return place;
}

/// Those of all lines; without any the line that runs.
std::vector<std::string> places_of(const Mistake& m) {
  std::vector<std::string> lines = m.details, places;
  lines.insert(lines.begin(), m.message);
  lines.push_back(m.hint);
  for (const std::string& line : lines)
    if (std::string place = place_at_end(line); !place.empty()) places.push_back(std::move(place));
  return places.empty() ? std::vector{to_string(here())} : places;
}

/// titop.Error of titop/errors.py, with the list of mistakes.
void raise(const Error& error) {
  const py::module_ errors = py::module_::import("titop.errors");
  py::list mistakes;
  for (const Mistake& m : error.mistakes())
    mistakes.append(errors.attr("Mistake")(std::string(to_string(m.code)), m.message, m.details,
                                           m.hint, places_of(m)));
  const py::object type = errors.attr("Error");
  PyErr_SetObject(type.ptr(), type(error.what(), mistakes).ptr());
}

}  // namespace

void bind_errors(py::module_& m) {
  static_cast<void>(m);
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    }
  });
}

}  // namespace titop::python
