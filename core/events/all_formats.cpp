#include "core/events/aedat4/aedat4.hpp"
#include "core/events/es/es.hpp"
#include "core/events/formats.hpp"
#include "core/events/hdf5/dsec_writer.hpp"
#include "core/events/hdf5/reader.hpp"
#include "core/events/native/native.hpp"
#include "core/events/prophesee/dat.hpp"
#include "core/events/prophesee/evt_raw.hpp"
#include "core/events/ros/mcap.hpp"
#include "core/events/ros/ros1_bag.hpp"
#include "core/events/ros/ros2_folder.hpp"
#include "core/events/ros/ros2_sqlite.hpp"
#include "core/events/text/ecd_text.hpp"
#include "core/events/text/text_writer.hpp"
#include "core/events/writer.hpp"

// The only file that knows every family of formats: a new one gets a line here.
namespace evbench {

const std::vector<EventFormat>& event_formats() {
  static const std::vector<EventFormat> formats = {
      native_format(), hdf5_format(), aedat4_format(), ros1_bag_format(), ros2_folder_format(), ros2_sqlite_format(),
      mcap_format(),   raw_format(),  dat_format(),    es_format(),       ecd_text_format()};
  return formats;
}

const std::vector<WritableFormat>& writable_formats() {
  static const std::vector<WritableFormat> formats = {
      {"native", ".evb", "evbench's own cache: mapped into memory, checksummed, fastest", PartFile::Needs::seeking,
       [](const std::string& path, const std::string& name, const RecordingHeader& header) {
         return std::unique_ptr<EventWriter>(std::make_unique<NativeWriter>(path, header, name));
       }},
      {"text", ".txt", "t x y p, as in the Event-Camera Dataset", PartFile::Needs::nothing,
       [](const std::string& path, const std::string& name, const RecordingHeader& header) {
         return std::unique_ptr<EventWriter>(std::make_unique<TextWriter>(path, name, header));
       }},
      {"hdf5", ".h5", "HDF5 in DSEC's layout", PartFile::Needs::name,
       [](const std::string& path, const std::string& name, const RecordingHeader& header) {
         return std::unique_ptr<EventWriter>(std::make_unique<DsecWriter>(path, name, header));
       }},
  };
  return formats;
}

}  // namespace evbench
