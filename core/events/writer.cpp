#include "core/events/writer.hpp"

#include "core/events/formats/dsec_writer.hpp"
#include "core/events/formats/native.hpp"
#include "core/events/formats/text_writer.hpp"

namespace evbench {

const std::vector<WritableFormat>& writable_formats() {
  static const std::vector<WritableFormat> formats = {
      {"native", ".evb", "evbench's own cache: mapped into memory, checksummed, fastest", PartFile::Needs::seeking,
       [](const std::string& path, const std::string& name, const RecordingHeader& header) {
         return std::unique_ptr<EventWriter>(std::make_unique<NativeWriter>(path, header, name));
       }},
      {"text", ".txt", "t x y p, as in the Event-Camera Dataset", PartFile::Needs::nothing,
       [](const std::string& path, const std::string& name, const RecordingHeader&) {
         return std::unique_ptr<EventWriter>(std::make_unique<TextWriter>(path, name));
       }},
      {"hdf5", ".h5", "HDF5 in DSEC's layout", PartFile::Needs::name,
       [](const std::string& path, const std::string& name, const RecordingHeader& header) {
         return std::unique_ptr<EventWriter>(std::make_unique<DsecWriter>(path, name, header));
       }},
  };
  return formats;
}

}  // namespace evbench
