#include <set>

#include "python.hpp"

namespace titop::python {

SourceLine here() {
  // Diagrams and systems keep these names as long as the process lives.
  static auto* const files = new std::set<std::string>;
  PyFrameObject* const frame = PyEval_GetFrame();
  if (!frame) return {};
  const auto code =
      py::reinterpret_steal<py::object>(reinterpret_cast<PyObject*>(PyFrame_GetCode(frame)));
  const auto file = code.attr("co_filename").cast<std::string>();
  return {files->insert(file).first->c_str(), PyFrame_GetLineNumber(frame)};
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

/// titop.Error of titop/errors.py, with the list of mistakes.
void raise(const Error& error) {
  const py::module_ errors = py::module_::import("titop.errors");
  py::list mistakes;
  for (const Mistake& m : error.mistakes())
    mistakes.append(errors.attr("Mistake")(std::string(to_string(m.code)), m.message, m.details,
                                           m.hint, to_string(here())));
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
