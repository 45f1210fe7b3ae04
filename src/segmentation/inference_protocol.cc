// SPDX-License-Identifier: Apache-2.0
#include "segmentation/inference_protocol.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <functional>

#include "base/error.h"

namespace rds {
namespace {

static_assert(std::endian::native == std::endian::little, "tensors are little-endian");

constexpr std::int64_t kMostElements = std::int64_t{1} << 28;

template <typename T>
void AppendNumber(const nlohmann::json& value, std::string& data) {
  T number{};
  if (value.is_boolean()) {
    number = static_cast<T>(value.get<bool>());
  } else if (value.is_number_integer()) {
    number = static_cast<T>(value.get<std::int64_t>());
  } else if (value.is_number()) {
    number = static_cast<T>(value.get<double>());
  } else {
    throw InputError("inference protocol: data is a list of numbers");
  }
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &number, sizeof(T));
  data.append(bytes.data(), bytes.size());
}

template <typename T>
std::vector<float> Convert(const std::string& data) {
  std::vector<float> values(data.size() / sizeof(T));
  for (std::size_t i = 0; i < values.size(); ++i) {
    T value;
    std::memcpy(&value, data.data() + i * sizeof(T), sizeof(T));
    values[i] = static_cast<float>(value);
  }
  return values;
}

// What is to be known of a type of numbers.
struct NumberType {
  const char* name;
  std::size_t bytes;
  void (*append)(const nlohmann::json&, std::string&);
  std::vector<float> (*convert)(const std::string&);
};

template <typename T>
constexpr NumberType TypeOf(const char* name) {
  return {name, sizeof(T), &AppendNumber<T>, &Convert<T>};
}

constexpr std::array kNumberTypes = {
    TypeOf<std::uint8_t>("UINT8"),   TypeOf<std::uint8_t>("BOOL"),    TypeOf<std::int8_t>("INT8"),
    TypeOf<std::uint16_t>("UINT16"), TypeOf<std::int16_t>("INT16"),   TypeOf<std::uint32_t>("UINT32"),
    TypeOf<std::int32_t>("INT32"),   TypeOf<std::uint64_t>("UINT64"), TypeOf<std::int64_t>("INT64"),
    TypeOf<float>("FP32"),           TypeOf<double>("FP64"),
};

const NumberType& NumberTypeOf(const std::string& name) {
  for (const NumberType& type : kNumberTypes) {
    if (name == type.name) {
      return type;
    }
  }
  throw InputError(fmt::format("inference protocol: tensors of type {} are not read", name));
}

// The lists in a list, too.
void ForEachLeaf(const nlohmann::json& value, const std::function<void(const nlohmann::json&)>& visit, int depth = 0) {
  if (!value.is_array()) {
    visit(value);
    return;
  }
  if (depth > 8) {
    throw InputError("inference protocol: data is nested too deep");
  }
  for (const nlohmann::json& element : value) {
    ForEachLeaf(element, visit, depth + 1);
  }
}

std::int64_t ElementsOf(const InferenceTensor& tensor) {
  std::int64_t elements = 1;
  for (const std::int64_t size : tensor.shape) {
    if (size < 0 || size > kMostElements || elements * size > kMostElements) {
      throw InputError(fmt::format("inference protocol: tensor '{}' has a size that cannot be", tensor.name));
    }
    elements *= size;
  }
  return elements;
}

void CheckSize(const InferenceTensor& tensor) {
  const std::int64_t elements = ElementsOf(tensor);
  const bool fits = tensor.datatype == "BYTES" ? static_cast<std::int64_t>(StringsOf(tensor).size()) == elements
                                               : tensor.data.size() == NumberTypeOf(tensor.datatype).bytes *
                                                                           static_cast<std::size_t>(elements);
  if (!fits) {
    throw InputError(fmt::format("inference protocol: tensor '{}' ({}): {} bytes are not those of its shape, {}",
                                 tensor.name, tensor.datatype, tensor.data.size(), fmt::join(tensor.shape, " x ")));
  }
}

InferenceTensor DecodeTensor(const nlohmann::json& json, std::string_view& binary) {
  InferenceTensor tensor;
  tensor.name = json.at("name").get<std::string>();
  tensor.datatype = json.at("datatype").get<std::string>();
  tensor.shape = json.at("shape").get<std::vector<std::int64_t>>();
  const nlohmann::json parameters = json.value("parameters", nlohmann::json::object());
  if (const auto size = parameters.find("binary_data_size"); size != parameters.end()) {
    const auto bytes = size->get<std::uint64_t>();
    if (bytes > binary.size()) {
      throw InputError(fmt::format("inference protocol: tensor '{}' is cut short", tensor.name));
    }
    tensor.data = binary.substr(0, bytes);
    binary.remove_prefix(bytes);
  } else if (tensor.datatype == "BYTES") {
    ForEachLeaf(json.at("data"),
                [&](const nlohmann::json& leaf) { tensor.data += AsBytesElement(leaf.get<std::string>()); });
  } else {
    const NumberType& type = NumberTypeOf(tensor.datatype);
    ForEachLeaf(json.at("data"), [&](const nlohmann::json& leaf) { type.append(leaf, tensor.data); });
  }
  CheckSize(tensor);
  return tensor;
}

}  // namespace

InferenceBody EncodeInference(nlohmann::json json, const char* key, const std::vector<InferenceTensor>& tensors) {
  nlohmann::json& list = json[key] = nlohmann::json::array();
  for (const InferenceTensor& tensor : tensors) {
    list.push_back({{"name", tensor.name},
                    {"datatype", tensor.datatype},
                    {"shape", tensor.shape},
                    {"parameters", {{"binary_data_size", tensor.data.size()}}}});
  }
  InferenceBody body;
  body.bytes = json.dump();
  body.json_length = body.bytes.size();
  for (const InferenceTensor& tensor : tensors) {
    body.bytes += tensor.data;
  }
  return body;
}

InferenceMessage DecodeInference(std::string_view body, std::optional<std::size_t> json_length, const char* key) {
  if (json_length && *json_length > body.size()) {
    throw InputError("inference protocol: the body is shorter than its header says");
  }
  std::string_view binary = json_length ? body.substr(*json_length) : std::string_view{};
  try {
    InferenceMessage message;
    message.json = nlohmann::json::parse(body.substr(0, json_length.value_or(body.size())));
    for (const nlohmann::json& tensor : message.json.at(key)) {
      message.tensors.push_back(DecodeTensor(tensor, binary));
    }
    return message;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("inference protocol: {}", error.what()));
  }
}

std::size_t ParseLength(const std::string& text) {
  std::size_t length = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), length);
  if (error != std::errc{} || stop != text.data() + text.size()) {
    throw InputError(fmt::format("inference protocol: {}: '{}' is no length", kInferenceHeader, text));
  }
  return length;
}

std::vector<float> FloatsOf(const InferenceTensor& tensor) {
  return NumberTypeOf(tensor.datatype).convert(tensor.data);
}

std::vector<std::string_view> StringsOf(const InferenceTensor& tensor) {
  std::vector<std::string_view> elements;
  std::string_view rest = tensor.data;
  while (!rest.empty()) {
    std::uint32_t length = 0;
    if (rest.size() < sizeof(length)) {
      throw InputError(fmt::format("inference protocol: tensor '{}' is cut short", tensor.name));
    }
    std::memcpy(&length, rest.data(), sizeof(length));
    rest.remove_prefix(sizeof(length));
    if (length > rest.size()) {
      throw InputError(fmt::format("inference protocol: tensor '{}' is cut short", tensor.name));
    }
    elements.push_back(rest.substr(0, length));
    rest.remove_prefix(length);
  }
  return elements;
}

std::string AsBytesElement(std::string_view bytes) {
  const auto length = static_cast<std::uint32_t>(bytes.size());
  std::string element(sizeof(length), '\0');
  std::memcpy(element.data(), &length, sizeof(length));
  return element.append(bytes);
}

}  // namespace rds
