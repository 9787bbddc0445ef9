// A peer on Fast DDS, ROS 2's default middleware, that does what it reads from its standard input:
//   sub TOPIC TYPE RELIABLE TRANSIENT   prints "DATA TOPIC SIZE HEX" for each sample
//   pub TOPIC TYPE HEX                  publishes that sample 20 times a second, reliably
//   quiet TOPIC                         stops publishing
//   call SERVICE TYPE HEX [DATA DATA]   calls a service as rmw_fastrtps does; prints "REPLY SERVICE HEX".
//                                       The user data is that of the writer and of the reader.
//   freeze                              reads nothing more, as a stopped debugger would
// Others' endpoints are printed as "WRITER|READER TOPIC TYPE RELIABLE DURABILITY USER_DATA".
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <map>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::SerializedPayload_t;
using eprosima::fastrtps::rtps::WriteParams;

static std::mutex out;
static void say(const std::string& line) {
  std::lock_guard<std::mutex> lock(out);
  std::cout << line << std::endl;
}

struct Raw {
  std::vector<unsigned char> bytes;
};

struct RawType : TopicDataType {
  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1 << 20;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    auto& bytes = static_cast<Raw*>(data)->bytes;
    memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = bytes.size();
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Raw*>(data)->bytes.assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return uint32_t(static_cast<Raw*>(data)->bytes.size()); };
  }
  void* createData() override { return new Raw; }
  void deleteData(void* data) override { delete static_cast<Raw*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

static std::string hex(const std::vector<unsigned char>& bytes, size_t most) {
  static const char* digits = "0123456789abcdef";
  std::string text;
  for (size_t i = 0; i < bytes.size() && i < most; i++) {
    text += digits[bytes[i] >> 4];
    text += digits[bytes[i] & 15];
  }
  return text;
}

static std::vector<unsigned char> unhex(const std::string& text) {
  std::vector<unsigned char> bytes;
  for (size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(std::stoi(text.substr(i, 2), nullptr, 16));
  return bytes;
}

static DomainParticipant* participant;

template <class Info>
static void tell(const char* kind, const Info& info) {
  if (participant != nullptr && info.guid().guidPrefix == participant->guid().guidPrefix) return;
  std::ostringstream line;
  std::string user(info.m_qos.m_userData.begin(), info.m_qos.m_userData.end());
  line << kind << " " << info.topicName() << " " << info.typeName() << " "
       << (info.m_qos.m_reliability.kind == RELIABLE_RELIABILITY_QOS) << " "
       << (info.m_qos.m_durability.kind >= TRANSIENT_LOCAL_DURABILITY_QOS) << " " << user;
  say(line.str());
}

struct Listener : DomainParticipantListener {
  void on_publisher_discovery(DomainParticipant*, eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override {
    tell(info.status == info.DISCOVERED_WRITER ? "WRITER" : "NO_WRITER", info.info);
  }
  void on_subscriber_discovery(DomainParticipant*, eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override {
    tell(info.status == info.DISCOVERED_READER ? "READER" : "NO_READER", info.info);
  }
  void on_participant_discovery(DomainParticipant*, eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override {
    if (info.status == info.DISCOVERED_PARTICIPANT)
      say("PARTICIPANT " + std::string(info.info.m_userData.begin(), info.info.m_userData.end()));
    else if (info.status != info.CHANGED_QOS_PARTICIPANT)
      say("NO_PARTICIPANT");
  }
};

static Publisher* publisher;
static Subscriber* subscriber;

static Topic* topic_of(const std::string& name, const std::string& type) {
  auto known = participant->lookup_topicdescription(name);
  if (known != nullptr) return static_cast<Topic*>(known);
  TypeSupport support(new RawType(type));
  support.register_type(participant);
  return participant->create_topic(name, type, TOPIC_QOS_DEFAULT);
}

static DataWriter* writer_of(const std::string& name, const std::string& type, const std::string& data = "") {
  auto qos = DATAWRITER_QOS_DEFAULT;
  qos.user_data().assign(data.begin(), data.end());
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.history().depth = 10;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  return publisher->create_datawriter(topic_of(name, type), qos);
}

static DataReader* reader_of(const std::string& name, const std::string& type, bool reliable, bool transient,
                             const std::string& data = "") {
  auto qos = DATAREADER_QOS_DEFAULT;
  qos.user_data().assign(data.begin(), data.end());
  qos.reliability().kind = reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
  if (transient) qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().depth = 200;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  return subscriber->create_datareader(topic_of(name, type), qos);
}

static void call(const std::string& service, const std::string& type, const Raw& request,
                 const std::string& asks, const std::string& takes) {
  auto reader = reader_of("rr" + service + "Reply", type + "Response_", true, false, takes);
  auto writer = writer_of("rq" + service + "Request", type + "Request_", asks);
  SubscriptionMatchedStatus in;
  PublicationMatchedStatus outgoing;
  for (int i = 0; i < 1000; i++) {
    reader->get_subscription_matched_status(in);
    writer->get_publication_matched_status(outgoing);
    if (in.current_count > 0 && outgoing.current_count > 0) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  WriteParams params;
  params.related_sample_identity().writer_guid(reader->guid());
  writer->write(const_cast<Raw*>(&request), params);
  auto number = params.sample_identity().sequence_number();
  for (int i = 0; i < 3000; i++) {
    Raw raw;
    SampleInfo info;
    while (reader->take_next_sample(&raw, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data && info.related_sample_identity.writer_guid() == reader->guid() &&
          info.related_sample_identity.sequence_number() == number) {
        say("REPLY " + service + " " + hex(raw.bytes, 1 << 20));
        subscriber->delete_datareader(reader);
        publisher->delete_datawriter(writer);
        return;
      }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  say("NO_REPLY " + service);
}

int main(int, char** argv) {
  Listener listener;
  auto qos = PARTICIPANT_QOS_DEFAULT;
  participant = DomainParticipantFactory::get_instance()->create_participant(
      atoi(argv[1]), qos, &listener, StatusMask::none());
  publisher = participant->create_publisher(PUBLISHER_QOS_DEFAULT);
  subscriber = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  std::map<std::string, DataReader*> readers;
  std::map<std::string, std::pair<DataWriter*, Raw>> writers;
  std::mutex lock;
  std::atomic<bool> frozen{false};
  std::thread([&] {
    for (int tick = 0;; tick++) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      std::lock_guard<std::mutex> guard(lock);
      if (frozen) continue;
      for (auto& [name, reader] : readers) {
        Raw raw;
        SampleInfo info;
        while (reader->take_next_sample(&raw, &info) == ReturnCode_t::RETCODE_OK)
          if (info.valid_data)
            say("DATA " + name + " " + std::to_string(raw.bytes.size()) + " " + hex(raw.bytes, 4096));
      }
      if (tick % 25 == 0)
        for (auto& [name, pair] : writers) pair.first->write(&pair.second);
    }
  }).detach();
  std::string line;
  while (std::getline(std::cin, line)) {
    std::istringstream words(line);
    std::string what, name, type, data;
    words >> what >> name >> type;
    if (what == "sub") {
      bool reliable, transient;
      words >> reliable >> transient;
      std::lock_guard<std::mutex> guard(lock);
      readers[name] = reader_of(name, type, reliable, transient);
    } else if (what == "pub") {
      words >> data;
      std::lock_guard<std::mutex> guard(lock);
      if (!writers.count(name)) writers[name].first = writer_of(name, type);
      writers[name].second = Raw{unhex(data)};
    } else if (what == "quiet") {
      std::lock_guard<std::mutex> guard(lock);
      publisher->delete_datawriter(writers[name].first);
      writers.erase(name);
    } else if (what == "call") {
      std::string asks, takes;
      words >> data >> asks >> takes;
      call(name, type, Raw{unhex(data)}, asks, takes);
    } else if (what == "freeze") {
      frozen = true;
    }
  }
  lock.lock();
  participant->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant);
  std::_Exit(0);
}
