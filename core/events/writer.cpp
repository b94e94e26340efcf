#include "core/events/writer.hpp"

#include "core/events/formats/dsec_writer.hpp"
#include "core/events/formats/native.hpp"
#include "core/events/formats/text_writer.hpp"

namespace evbench {

const std::vector<WritableFormat>& writable_formats() {
  static const std::vector<WritableFormat> formats = {
      {"native", ".evb", "evbench's own cache: mapped into memory, checksummed, fastest", false,
       [](const std::string& path, const RecordingHeader& header) -> std::unique_ptr<EventWriter> {
         return std::make_unique<NativeWriter>(path, header);
       }},
      {"text", ".txt", "t x y p, as in the Event-Camera Dataset", false,
       [](const std::string& path, const RecordingHeader&) -> std::unique_ptr<EventWriter> {
         return std::make_unique<TextWriter>(path);
       }},
      {"hdf5", ".h5", "HDF5 in DSEC's layout", true,
       [](const std::string& path, const RecordingHeader& header) -> std::unique_ptr<EventWriter> {
         return std::make_unique<DsecWriter>(path, header);
       }},
  };
  return formats;
}

}  // namespace evbench
